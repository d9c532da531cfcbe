#include "support/npy_array.hpp"

#include "support/temporary_folder.hpp"

#include <algorithm>
#include <regex>

namespace lamina::test {

std::uint64_t NpyArray::setCount() const {
    return static_cast<std::uint64_t>(std::count(values.begin(), values.end(), std::uint8_t{1}));
}

NpyArray readNpyArray(const std::string& file) {
    const std::string bytes = readBytes(file);
    if (bytes.size() < 10 || bytes.substr(0, 6) != "\x93NUMPY" || bytes[6] != 1) {
        ADD_FAILURE() << file << " is no .npy 1.0 file";
        return {};
    }
    const std::size_t start =
        10 + static_cast<unsigned char>(bytes[8]) + 256u * static_cast<unsigned char>(bytes[9]);
    const std::string header = bytes.substr(10, start - 10);
    std::smatch shape;
    if (!std::regex_search(header, shape, std::regex(R"(\((\d+), (\d+), (\d+)\))")) ||
        header.find("'|u1'") == std::string::npos ||
        header.find("'fortran_order': False") == std::string::npos) {
        ADD_FAILURE() << file << ": header " << header;
        return {};
    }
    NpyArray array;
    array.counts = {std::stoul(shape[3]), std::stoul(shape[2]), std::stoul(shape[1])};
    array.values.assign(bytes.begin() + static_cast<std::ptrdiff_t>(start), bytes.end());
    const bool isBinary = std::all_of(array.values.begin(), array.values.end(),
                                      [](std::uint8_t value) { return value <= 1; });
    if (array.values.size() != std::size_t{array.counts.x} * array.counts.y * array.counts.z ||
        !isBinary) {
        ADD_FAILURE() << file << ": expected one byte, 0 or 1, a voxel; header " << header;
        return {};
    }
    return array;
}

} // namespace lamina::test
