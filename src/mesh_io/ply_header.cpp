#include "mesh_io/ply_header.hpp"

#include "mesh_io/text_lines.hpp"

#include <algorithm>

namespace lamina::detail {
namespace {

std::optional<PlyType> typeOf(std::string_view word) {
    struct Name {
        std::string_view text;
        PlyType type;
    };
    constexpr Name kNames[] = {
        {"char", PlyType::Int8},      {"int8", PlyType::Int8},     {"uchar", PlyType::UInt8},
        {"uint8", PlyType::UInt8},    {"short", PlyType::Int16},   {"int16", PlyType::Int16},
        {"ushort", PlyType::UInt16},  {"uint16", PlyType::UInt16}, {"int", PlyType::Int32},
        {"int32", PlyType::Int32},    {"uint", PlyType::UInt32},   {"uint32", PlyType::UInt32},
        {"float", PlyType::Float},    {"float32", PlyType::Float}, {"double", PlyType::Double},
        {"float64", PlyType::Double},
    };
    for (const Name& name : kNames)
        if (name.text == word)
            return name.type;
    return std::nullopt;
}

/// The header's lines. All end as the first one does, so that a body that starts with a line feed
/// is told from a line end of two characters.
class HeaderLines {
public:
    explicit HeaderLines(std::string_view bytes)
        : mBytes(bytes) {
        const std::size_t end = bytes.find_first_of("\r\n");
        if (end != std::string_view::npos)
            mLineEnd = bytes.substr(end).starts_with("\r\n") ? "\r\n" : bytes.substr(end, 1);
    }
    bool next() {
        if (mLineEnd.empty() || mOffset >= mBytes.size())
            return false;
        // A line longer than this is no header; do not search megabytes of a body for its end.
        constexpr std::size_t kLongestLine = 1u << 16u;
        const std::size_t length = mBytes.substr(mOffset, kLongestLine).find(mLineEnd);
        if (length == std::string_view::npos)
            return false;
        mLine = mBytes.substr(mOffset, length);
        mOffset += length + mLineEnd.size();
        ++mNumber;
        return true;
    }
    [[nodiscard]] std::string_view line() const { return mLine; }
    [[nodiscard]] std::uint64_t number() const { return mNumber; }
    [[nodiscard]] std::size_t offset() const { return mOffset; }

private:
    std::string_view mBytes, mLineEnd, mLine;
    std::size_t mOffset = 0;
    std::uint64_t mNumber = 0;
};

class HeaderReader {
public:
    HeaderReader(std::string_view bytes, ReadJob& job, PlyHeader& header)
        : mBytes(bytes)
        , mLines(bytes)
        , mJob(job)
        , mHeader(header) {}

    bool read() {
        if (!mLines.next() || Words(mLines.line()).next() != "ply")
            return mJob.fail(atLine(1), "'ply'", quoted(mBytes.substr(0, 16)));
        while (mLines.next()) {
            Words words(mLines.line());
            const std::string_view keyword = words.next();
            if (keyword == "end_header")
                return finish();
            if (!readStatement(keyword, words))
                return false;
        }
        return mJob.fail(atLine(mLines.number() + 1), "'end_header'",
                         "no further line of a header");
    }

private:
    static constexpr std::size_t kMaxElements = 1000;

    [[nodiscard]] SourceLocation here() const { return atLine(mLines.number()); }

    bool readStatement(std::string_view keyword, Words words) {
        if (keyword == "comment" || keyword == "obj_info" || keyword.empty())
            return true;
        if (keyword == "format")
            return readFormat(words);
        if (keyword == "element")
            return readElement(words);
        if (keyword == "property")
            return readProperty(words);
        return mJob.fail(here(), "a PLY header statement", quoted(keyword));
    }

    bool readFormat(Words words) {
        const std::string_view format = words.next();
        if (format == "ascii")
            mHeader.encoding = PlyEncoding::Ascii;
        else if (format == "binary_little_endian")
            mHeader.encoding = PlyEncoding::LittleEndian;
        else if (format == "binary_big_endian")
            mHeader.encoding = PlyEncoding::BigEndian;
        else
            return mJob.fail(here(), "format ascii, binary_little_endian or binary_big_endian",
                             quoted(format));
        if (const std::string_view version = words.next(); version != "1.0")
            return mJob.fail(
                readError(ErrorCode::Unsupported, here(), "PLY version 1.0", quoted(version)));
        mHaveFormat = true;
        return true;
    }

    bool readElement(Words words) {
        PlyElement element;
        element.name = words.next();
        element.line = mLines.number();
        const std::string_view count = words.next();
        const std::optional<std::uint64_t> value = parseInteger<std::uint64_t>(count);
        if (element.name.empty() || !value || !words.atEnd())
            return mJob.fail(here(), "an element's name and its count", quoted(mLines.line()));
        element.count = *value;
        if (mHeader.elements.size() == kMaxElements)
            return mJob.fail(here(), "at most " + std::to_string(kMaxElements) + " elements",
                             "more");
        for (const PlyElement& other : mHeader.elements)
            if (other.name == element.name)
                return mJob.fail(here(), "each element once", quoted(element.name) + " again");
        mHeader.elements.push_back(std::move(element));
        return true;
    }

    bool readProperty(Words words) {
        if (mHeader.elements.empty())
            return mJob.fail(here(), "an element before its properties", "none");
        PlyProperty property;
        std::string_view typeName = words.next();
        if (typeName == "list") {
            property.isList = true;
            const std::string_view countName = words.next();
            const std::optional<PlyType> countType = typeOf(countName);
            if (!countType || *countType == PlyType::Float || *countType == PlyType::Double)
                return mJob.fail(here(), "an integer type for the list's count", quoted(countName));
            property.countType = *countType;
            typeName = words.next();
        }
        const std::optional<PlyType> type = typeOf(typeName);
        if (!type)
            return mJob.fail(here(), "a property type (float, uchar, ...)", quoted(typeName));
        property.type = *type;
        property.name = words.next();
        if (property.name.empty() || !words.atEnd())
            return mJob.fail(here(), "one name for the property", quoted(mLines.line()));
        mHeader.elements.back().properties.push_back(std::move(property));
        return true;
    }

    bool finish() {
        if (!mHaveFormat)
            return mJob.fail(here(), "a 'format' line in the header", "none");
        mHeader.bodyOffset = mLines.offset();
        mHeader.bodyFirstLine = mLines.number() + 1;
        return true;
    }

    std::string_view mBytes;
    HeaderLines mLines;
    ReadJob& mJob;
    PlyHeader& mHeader;
    bool mHaveFormat = false;
};

} // namespace

bool PlyElement::hasLists() const {
    return std::any_of(properties.begin(), properties.end(),
                       [](const PlyProperty& property) { return property.isList; });
}

std::size_t PlyElement::minBytes(PlyEncoding encoding) const {
    if (encoding == PlyEncoding::Ascii)
        return 2 * properties.size();
    std::size_t bytes = 0;
    for (const PlyProperty& property : properties)
        bytes += plyTypeBytes(property.isList ? property.countType : property.type);
    return bytes;
}

bool readPlyHeader(std::string_view bytes, ReadJob& job, PlyHeader& header) {
    return HeaderReader(bytes, job, header).read();
}

} // namespace lamina::detail
