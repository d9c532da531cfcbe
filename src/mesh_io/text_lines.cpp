#include "mesh_io/text_lines.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

namespace lamina::detail {

TextLines::TextLines(std::string_view text, std::uint64_t firstLine)
    : mText(text)
    , mNextNumber(firstLine) {
    if (mText.starts_with("\xEF\xBB\xBF"))
        mPosition = 3;
}

std::size_t TextLines::findLineEnd() {
    if (mNextLineFeed < mPosition || mPosition == 0) {
        const std::size_t found = mText.find('\n', mPosition);
        mNextLineFeed = found == std::string_view::npos ? mText.size() : found;
    }
    const void* carriageReturn =
        std::memchr(mText.data() + mPosition, '\r', mNextLineFeed - mPosition);
    return carriageReturn == nullptr
               ? mNextLineFeed
               : static_cast<std::size_t>(static_cast<const char*>(carriageReturn) - mText.data());
}

bool TextLines::nextJoined() {
    if (!next())
        return false;
    if (!mLine.ends_with('\\')) [[likely]]
        return true;
    const std::uint64_t first = mNumber;
    mJoined.clear();
    bool more = true;
    while (more && mLine.ends_with('\\')) {
        mJoined.append(mLine.substr(0, mLine.size() - 1)).push_back(' ');
        more = next();
    }
    if (more)
        mJoined.append(mLine);
    mLine = mJoined;
    mNumber = first;
    return true;
}

bool TextLines::nextContent(char comment) {
    while (next()) {
        if (comment != '\0')
            mLine = mLine.substr(0, mLine.find(comment));
        if (!std::all_of(mLine.begin(), mLine.end(), isBlank))
            return true;
    }
    return false;
}

double outOfRangeValue(std::string_view word) {
    const bool negative = word.starts_with('-');
    const std::size_t exponentAt = std::min(word.find_first_of("eE"), word.size());
    const std::string_view mantissa = word.substr(0, exponentAt);
    const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
    const std::size_t digit = mantissa.find_first_of("123456789");
    if (digit == std::string_view::npos)
        return 0.0;

    // Power of ten of the leading digit: large means overflow, small means underflow.
    double power = static_cast<double>(point) - static_cast<double>(digit);
    if (exponentAt < word.size()) {
        const std::string_view exponent = word.substr(exponentAt + 1);
        const double sign = exponent.starts_with('-') ? -1.0 : 1.0;
        const std::string_view digits = exponent.substr(exponent.find_first_of("0123456789"));
        std::uint32_t value = 0;
        const bool fits =
            std::from_chars(digits.data(), digits.data() + digits.size(), value).ec == std::errc();
        power += sign * (fits ? value : std::numeric_limits<double>::infinity());
    }
    const double magnitude = power > 0 ? std::numeric_limits<double>::infinity() : 0.0;
    return negative ? -magnitude : magnitude;
}

} // namespace lamina::detail
