#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lamina::detail {

/// Spreads the bits of a key over a hash.
[[nodiscard]] inline std::uint64_t mixBits(std::uint64_t key) {
    key = (key ^ (key >> 30u)) * 0xBF58476D1CE4E5B9u;
    key = (key ^ (key >> 27u)) * 0x94D049BB133111EBu;
    return key ^ (key >> 31u);
}

/// Finds which of the caller's items, named by 32-bit indices, equals a new one: a hash table with
/// open addressing, at most half full.
class IndexTable {
public:
    /// The index of the item for which matches(index) holds; if there is none, `fresh` is entered
    /// and returned.
    template<class Matches>
    [[nodiscard]] std::uint32_t findOrInsert(std::uint64_t hash, std::uint32_t fresh,
                                             Matches&& matches) {
        if ((mCount + 1) * 2 > mSlots.size())
            grow();
        const auto tag = static_cast<std::uint32_t>(hash);
        const std::size_t mask = mSlots.size() - 1;
        std::size_t place = tag & mask;
        for (; mSlots[place].index != kEmpty; place = (place + 1) & mask)
            if (mSlots[place].tag == tag && matches(mSlots[place].index))
                return mSlots[place].index;
        mSlots[place] = {tag, fresh};
        ++mCount;
        return fresh;
    }

private:
    static constexpr std::uint32_t kEmpty = 0xFFFFFFFFu;
    struct Slot {
        std::uint32_t tag = 0;
        std::uint32_t index = kEmpty;
    };

    void grow() {
        std::vector<Slot> slots(mSlots.empty() ? 64 : mSlots.size() * 2);
        const std::size_t mask = slots.size() - 1;
        for (const Slot& slot : mSlots) {
            if (slot.index == kEmpty)
                continue;
            std::size_t place = slot.tag & mask;
            while (slots[place].index != kEmpty)
                place = (place + 1) & mask;
            slots[place] = slot;
        }
        mSlots.swap(slots);
    }

    std::vector<Slot> mSlots;
    std::size_t mCount = 0;
};

} // namespace lamina::detail
