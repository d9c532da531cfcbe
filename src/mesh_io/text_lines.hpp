#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace lamina::detail {

[[nodiscard]] inline bool isBlank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

/// The blank-separated words of a line.
class Words {
public:
    Words() = default;
    explicit Words(std::string_view line)
        : mRest(line) {}

    /// The next word, empty at the end of the line.
    [[nodiscard]] std::string_view next() {
        skipBlanks();
        std::size_t length = 0;
        while (length < mRest.size() && !isBlank(mRest[length]))
            ++length;
        const std::string_view word = mRest.substr(0, length);
        mRest.remove_prefix(length);
        return word;
    }
    [[nodiscard]] bool atEnd() {
        skipBlanks();
        return mRest.empty();
    }
    [[nodiscard]] std::string_view rest() const { return mRest; }

private:
    void skipBlanks() {
        std::size_t blanks = 0;
        while (blanks < mRest.size() && isBlank(mRest[blanks]))
            ++blanks;
        mRest.remove_prefix(blanks);
    }

    std::string_view mRest;
};

/// Walks the lines of a text that end with LF, CR or CRLF; a UTF-8 byte-order mark is skipped.
class TextLines {
public:
    /// Lines are counted from `firstLine`.
    explicit TextLines(std::string_view text, std::uint64_t firstLine = 1);

    /// Moves to the next line. False at the end of the text.
    bool next() {
        if (mPosition >= mText.size())
            return false;
        const std::size_t end = findLineEnd();
        mLine = mText.substr(mPosition, end - mPosition);
        mPosition = end + 1;
        if (end + 1 < mText.size() && mText[end] == '\r' && mText[end + 1] == '\n')
            ++mPosition;
        mNumber = mNextNumber++;
        return true;
    }
    /// As next(), but joins lines that end with a backslash.
    bool nextJoined();
    /// Moves to the next line that holds something besides blanks. With a comment character, what
    /// follows it is cut off first.
    bool nextContent(char comment = '\0');

    [[nodiscard]] std::string_view line() const { return mLine; }
    /// Number of the current line (the first of joined ones).
    [[nodiscard]] std::uint64_t number() const { return mNumber; }
    /// Bytes walked past.
    [[nodiscard]] std::size_t position() const {
        return mPosition < mText.size() ? mPosition : mText.size();
    }
    [[nodiscard]] std::size_t remaining() const { return mText.size() - position(); }

private:
    [[nodiscard]] std::size_t findLineEnd();

    std::string_view mText;
    std::size_t mPosition = 0;
    std::size_t mNextLineFeed =
        0; ///< Kept, so that texts without any cost one search, not one a line.
    std::uint64_t mNumber = 0;
    std::uint64_t mNextNumber;
    std::string_view mLine;
    std::string mJoined;
};

/// What std::from_chars leaves untouched: the sign of overflow or underflow. `word` is a number out
/// of range; the result is zero or infinite.
[[nodiscard]] double outOfRangeValue(std::string_view word);

/// A whole word as a number: decimal, exponent, leading '+', nan, inf. Out of range gives infinity
/// or zero. Nothing if the word is anything else.
template<class Real>
[[nodiscard]] std::optional<Real> parseReal(std::string_view word) {
    if (word.size() > 1 && word[0] == '+' && word[1] != '-')
        word.remove_prefix(1);
    Real value = 0;
    const char* end = word.data() + word.size();
    const std::from_chars_result result = std::from_chars(word.data(), end, value);
    if (result.ptr != end || word.empty())
        return std::nullopt;
    if (result.ec == std::errc::result_out_of_range) [[unlikely]]
        return static_cast<Real>(outOfRangeValue(word));
    return result.ec == std::errc() ? std::optional<Real>(value) : std::nullopt;
}

/// A whole word as a decimal integer with optional sign.
template<class Integer>
[[nodiscard]] std::optional<Integer> parseInteger(std::string_view word) {
    if (word.size() > 1 && word[0] == '+' && word[1] != '-')
        word.remove_prefix(1);
    Integer value = 0;
    const char* end = word.data() + word.size();
    const std::from_chars_result result = std::from_chars(word.data(), end, value);
    if (result.ptr != end || result.ec != std::errc() || word.empty())
        return std::nullopt;
    return value;
}

} // namespace lamina::detail
