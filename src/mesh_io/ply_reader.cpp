#include "mesh_io/mesh_readers.hpp"
#include "mesh_io/ply_header.hpp"
#include "mesh_io/polygon_triangulator.hpp"
#include "mesh_io/text_lines.hpp"

#include <array>
#include <bit>
#include <cstring>

namespace lamina::detail {
namespace {

/// The values of a text body, row by row.
class TextSource {
public:
    TextSource(std::string_view bytes, const PlyHeader& header, ReadJob& job)
        : mLines(bytes.substr(header.bodyOffset), header.bodyFirstLine)
        , mBodyOffset(header.bodyOffset)
        , mJob(job) {}

    [[nodiscard]] SourceLocation here() const { return atLine(mLines.number()); }
    [[nodiscard]] std::size_t remaining() const { return mLines.remaining(); }
    [[nodiscard]] std::size_t position() const { return mBodyOffset + mLines.position(); }

    /// How many values the rest of the row can hold.
    [[nodiscard]] std::uint64_t mostValues(PlyType) const { return (mWords.rest().size() + 1) / 2; }

    bool beginRow(const PlyElement& element, std::uint64_t index) {
        if (!mLines.nextContent())
            return mJob.fail(here(), std::to_string(element.count) + " " + element.name + " rows",
                             "the end of the file after " + std::to_string(index));
        mWords = Words(mLines.line());
        return true;
    }
    bool read(PlyType type, double& value) {
        const std::string_view word = mWords.next();
        std::optional<double> parsed;
        if (type == PlyType::Float)
            parsed = parseReal<float>(word);
        else
            parsed = parseReal<double>(word);
        if (!parsed)
            return mJob.fail(here(), "a number",
                             word.empty() ? "the end of the line" : quoted(word));
        value = *parsed;
        return true;
    }
    bool skip(PlyType type, std::uint64_t count) {
        double ignored = 0;
        for (std::uint64_t i = 0; i < count; ++i)
            if (!read(type, ignored))
                return false;
        return true;
    }
    bool endRow() {
        return mWords.atEnd() ||
               mJob.fail(here(), "the end of the line", quoted(mWords.rest()) + " more");
    }
    bool skipFixedRows(const PlyElement& element) {
        for (std::uint64_t i = 0; i < element.count; ++i) {
            if (!beginRow(element, i))
                return false;
            for (const PlyProperty& property : element.properties)
                if (!skip(property.type, 1))
                    return false;
            if (!endRow() || !mJob.advance(position()))
                return false;
        }
        return true;
    }
    bool expectEnd() {
        return !mLines.nextContent() ||
               mJob.fail(here(), "the end of the file after the last element",
                         quoted(mLines.line()));
    }

private:
    TextLines mLines;
    Words mWords;
    std::size_t mBodyOffset;
    ReadJob& mJob;
};

/// The values of a binary body.
template<std::endian Order>
class BinarySource {
public:
    BinarySource(std::string_view bytes, const PlyHeader& header, ReadJob& job)
        : mBytes(bytes)
        , mPosition(header.bodyOffset)
        , mJob(job) {}

    [[nodiscard]] SourceLocation here() const { return atByte(mPosition); }
    [[nodiscard]] std::size_t remaining() const { return mBytes.size() - mPosition; }
    [[nodiscard]] std::size_t position() const { return mPosition; }

    /// How many values the rest of the file can hold.
    [[nodiscard]] std::uint64_t mostValues(PlyType type) const {
        return remaining() / plyTypeBytes(type);
    }

    bool beginRow(const PlyElement&, std::uint64_t) { return true; }
    bool endRow() { return true; }
    bool read(PlyType type, double& value) {
        switch (type) {
        case PlyType::Int8:
            return readAs<std::int8_t>(value);
        case PlyType::UInt8:
            return readAs<std::uint8_t>(value);
        case PlyType::Int16:
            return readAs<std::int16_t>(value);
        case PlyType::UInt16:
            return readAs<std::uint16_t>(value);
        case PlyType::Int32:
            return readAs<std::int32_t>(value);
        case PlyType::UInt32:
            return readAs<std::uint32_t>(value);
        case PlyType::Float:
            return readAs<float>(value);
        case PlyType::Double:
            return readAs<double>(value);
        }
        return false;
    }
    bool skip(PlyType type, std::uint64_t count) {
        if (count > remaining() / plyTypeBytes(type))
            return failAtEnd(count * plyTypeBytes(type));
        mPosition += count * plyTypeBytes(type);
        return true;
    }
    /// The caller has checked that the rows fit.
    bool skipFixedRows(const PlyElement& element) {
        mPosition += element.count * element.minBytes(PlyEncoding::LittleEndian);
        return true;
    }
    bool expectEnd() {
        return remaining() == 0 || mJob.fail(here(), "the end of the file after the last element",
                                             std::to_string(remaining()) + " bytes more");
    }

private:
    template<class T>
    bool readAs(double& value) {
        if (remaining() < sizeof(T)) [[unlikely]]
            return failAtEnd(sizeof(T));
        std::array<char, sizeof(T)> raw;
        std::memcpy(raw.data(), mBytes.data() + mPosition, sizeof(T));
        if constexpr (Order != std::endian::native)
            for (std::size_t i = 0; i < sizeof(T) / 2; ++i)
                std::swap(raw[i], raw[sizeof(T) - 1 - i]);
        value = static_cast<double>(std::bit_cast<T>(raw));
        mPosition += sizeof(T);
        return true;
    }
    bool failAtEnd(std::uint64_t needed) {
        return mJob.fail(here(), std::to_string(needed) + " more bytes",
                         "the end of the file after " + std::to_string(remaining()));
    }

    std::string_view mBytes;
    std::size_t mPosition;
    ReadJob& mJob;
};

/// What a vertex property means; the first value is the place of x in a row.
enum Role : std::size_t { kX, kY, kZ, kNx, kNy, kNz, kRed, kGreen, kBlue, kAlpha, kIgnored };

constexpr std::array<std::string_view, kIgnored> kRoleNames = {
    "x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", "alpha"};

struct VertexProperty {
    PlyProperty property;
    std::size_t role = kIgnored;
    double scale = 1.0;
};

Role roleOf(const PlyProperty& property) {
    std::string_view name = property.name;
    if (name.starts_with("diffuse_"))
        name.remove_prefix(8);
    for (std::size_t role = 0; role < kRoleNames.size(); ++role)
        if (!property.isList &&
            (property.name == kRoleNames[role] || (role >= kRed && name == kRoleNames[role])))
            return static_cast<Role>(role);
    return kIgnored;
}

/// Colours of integer type count to 255, 16-bit ones to 65535.
double colorScale(PlyType type) {
    if (type == PlyType::Float || type == PlyType::Double)
        return 1.0;
    return type == PlyType::Int16 || type == PlyType::UInt16 ? 1.0 / 65535.0 : 1.0 / 255.0;
}

template<class Source>
class BodyReader {
public:
    BodyReader(std::string_view bytes, const PlyHeader& header, ReadJob& job)
        : mHeader(header)
        , mSource(bytes, header, job)
        , mJob(job) {}

    Result<TriangleMesh> read() {
        for (const PlyElement& element : mHeader.elements)
            if (!checkRoom(element) || !readElement(element))
                return mJob.takeError();
        if (!mSource.expectEnd())
            return mJob.takeError();
        if (const auto checked = mIndices.resolve(mMesh.positions.size(), 0, "vertex"); !checked)
            return checked.error();
        if (const auto checked = mNonFinite.resolve(mMesh); !checked)
            return checked.error();
        return std::move(mMesh);
    }

private:
    bool checkRoom(const PlyElement& element) {
        // The last row of a text may lack its line end.
        const bool text = mHeader.encoding == PlyEncoding::Ascii;
        const std::uint64_t room = std::uint64_t{mSource.remaining()} + (text ? 1 : 0);
        const std::size_t least = element.minBytes(mHeader.encoding);
        if (least == 0 || element.count <= room / least)
            return true;
        return mJob.fail(atLine(element.line),
                         "room for " + std::to_string(element.count) + " " + element.name +
                             " elements of at least " + std::to_string(least) + " bytes",
                         std::to_string(mSource.remaining()) + " bytes left");
    }

    bool readElement(const PlyElement& element) {
        if (element.properties.empty())
            return true; // its rows are empty, however many
        if (element.name == "vertex")
            return readVertices(element);
        if (element.name == "face")
            return readIndexLists(element, &BodyReader::addPolygon);
        if (element.name == "tristrips")
            return readIndexLists(element, &BodyReader::addStrip);
        if (!element.hasLists())
            return mSource.skipFixedRows(element);
        for (std::uint64_t i = 0; i < element.count; ++i) {
            if (!mSource.beginRow(element, i))
                return false;
            for (const PlyProperty& property : element.properties)
                if (!skipProperty(property))
                    return false;
            if (!mSource.endRow() || !mJob.advance(mSource.position()))
                return false;
        }
        return true;
    }

    bool readVertices(const PlyElement& element) {
        std::array<bool, kIgnored + 1> present{};
        std::vector<VertexProperty> properties;
        for (const PlyProperty& property : element.properties) {
            const Role role = roleOf(property);
            if (role != kIgnored && present[role])
                return mJob.fail(atLine(element.line), "each vertex property once",
                                 quoted(property.name) + " again");
            present[role] = true;
            properties.push_back({property, role, role >= kRed ? colorScale(property.type) : 1.0});
        }
        if (!present[kX] || !present[kY] || !present[kZ])
            return mJob.fail(atLine(element.line), "vertex properties x, y and z", "not all three");
        if (element.count > kMaxVertexCount)
            return mJob.fail(atLine(element.line), "fewer than 2^32 vertices",
                             std::to_string(element.count));
        const bool haveNormals = present[kNx] && present[kNy] && present[kNz];
        const bool haveColors = present[kRed] && present[kGreen] && present[kBlue];
        mMesh.positions.reserve(element.count);
        mMesh.normals.reserve(haveNormals ? element.count : 0);
        mMesh.colors.reserve(haveColors ? element.count : 0);

        std::array<double, kIgnored + 1> row{};
        row[kAlpha] = 1.0;
        for (std::uint64_t i = 0; i < element.count; ++i) {
            const SourceLocation start = mSource.here();
            if (!mSource.beginRow(element, i) || !readVertexRow(properties, row) ||
                !mJob.advance(mSource.position()))
                return false;
            const glm::vec3 position(toFloat(row[kX]), toFloat(row[kY]), toFloat(row[kZ]));
            mNonFinite.check(i, position, lineOr(start));
            mMesh.positions.push_back(position);
            if (haveNormals)
                mMesh.normals.emplace_back(toFloat(row[kNx]), toFloat(row[kNy]), toFloat(row[kNz]));
            if (haveColors)
                mMesh.colors.emplace_back(
                    unitRange(toFloat(row[kRed])), unitRange(toFloat(row[kGreen])),
                    unitRange(toFloat(row[kBlue])), unitRange(toFloat(row[kAlpha])));
        }
        return true;
    }

    /// A row of text is known once it is read, a binary one before.
    [[nodiscard]] SourceLocation lineOr(SourceLocation start) const {
        return start.unit == SourceLocation::Unit::Byte ? start : mSource.here();
    }

    bool readVertexRow(const std::vector<VertexProperty>& properties,
                       std::array<double, kIgnored + 1>& row) {
        for (const VertexProperty& entry : properties) {
            if (entry.property.isList) {
                if (!skipProperty(entry.property))
                    return false;
                continue;
            }
            double value = 0;
            if (!mSource.read(entry.property.type, value))
                return false;
            row[entry.role] = value * entry.scale;
        }
        return mSource.endRow();
    }

    bool readCount(const PlyProperty& list, std::uint64_t& count) {
        const SourceLocation where = mSource.here();
        double value = 0;
        if (!mSource.read(list.countType, value))
            return false;
        // The comparison also stops NaN.
        const std::uint64_t most = mSource.mostValues(list.type);
        if (!(value >= 0.0 && value <= static_cast<double>(most)) ||
            value != static_cast<double>(static_cast<std::uint64_t>(value)))
            return mJob.fail(where,
                             "a list count up to " + std::to_string(most) +
                                 " (there is no room for more)",
                             numberText(value));
        count = static_cast<std::uint64_t>(value);
        return true;
    }

    bool skipProperty(const PlyProperty& property) {
        std::uint64_t count = 1;
        if (property.isList && !readCount(property, count))
            return false;
        return mSource.skip(property.type, count);
    }

    using AddIndices = bool (BodyReader::*)(SourceLocation);

    bool readIndexLists(const PlyElement& element, AddIndices add) {
        const PlyProperty* indices = nullptr;
        for (const PlyProperty& property : element.properties)
            if (property.isList &&
                (property.name == "vertex_indices" || property.name == "vertex_index"))
                indices = &property;
        if (indices == nullptr)
            return mJob.fail(atLine(element.line),
                             "a list property vertex_indices of " + element.name, "none");
        if (element.name == "face")
            mMesh.triangles.reserve(element.count);
        for (std::uint64_t i = 0; i < element.count; ++i) {
            const SourceLocation start = mSource.here();
            if (!mSource.beginRow(element, i))
                return false;
            for (const PlyProperty& property : element.properties)
                if (!(&property == indices ? readList(property) : skipProperty(property)))
                    return false;
            if (!mSource.endRow() || !mJob.advance(mSource.position()) ||
                !(this->*add)(lineOr(start)))
                return false;
        }
        return true;
    }

    bool readList(const PlyProperty& property) {
        std::uint64_t count = 0;
        if (!readCount(property, count))
            return false;
        mList.clear();
        mList.reserve(count);
        for (std::uint64_t i = 0; i < count; ++i) {
            double value = 0;
            if (!mSource.read(property.type, value))
                return false;
            mList.push_back(value);
        }
        return true;
    }

    bool toIndex(double value, SourceLocation where, std::uint32_t& index) {
        if (!(value >= 0.0 && value < static_cast<double>(kMaxVertexCount)) ||
            value != static_cast<double>(static_cast<std::uint32_t>(value)))
            return mJob.fail(readError(ErrorCode::InvalidMesh, where,
                                       "vertex indices that are whole numbers from 0",
                                       numberText(value)));
        index = static_cast<std::uint32_t>(value);
        mIndices.note(index, where);
        return true;
    }

    bool addPolygon(SourceLocation where) {
        if (mList.size() < 3)
            return mJob.fail(where, "a face of at least 3 corners", std::to_string(mList.size()));
        mPolygon.resize(mList.size());
        for (std::size_t i = 0; i < mList.size(); ++i)
            if (!toIndex(mList[i], where, mPolygon[i]))
                return false;
        const std::size_t first = mMesh.triangles.size();
        mTriangulator.append(mMesh.positions, mPolygon, mMesh.triangles);
        lookUp(std::span(mMesh.triangles).subspan(first), mPolygon);
        return true;
    }

    /// Strips are divided by -1. Triangles with a repeated corner only steer the strip.
    bool addStrip(SourceLocation where) {
        glm::uvec3 window(0);
        std::uint64_t length = 0;
        for (const double value : mList) {
            if (value == -1.0) {
                length = 0;
                continue;
            }
            std::uint32_t index = 0;
            if (!toIndex(value, where, index))
                return false;
            window = {window.y, window.z, index};
            const bool real = window.x != window.y && window.y != window.z && window.z != window.x;
            if (++length < 3 || !real)
                continue;
            const bool odd = length % 2 == 0;
            mMesh.triangles.push_back(odd ? glm::uvec3(window.y, window.x, window.z) : window);
        }
        return true;
    }

    [[nodiscard]] static std::string numberText(double value) {
        std::array<char, 32> text{};
        const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
        return {text.data(), result.ptr};
    }

    const PlyHeader& mHeader;
    Source mSource;
    ReadJob& mJob;
    TriangleMesh mMesh;
    NonFiniteVertices mNonFinite;
    IndexCheck mIndices;
    std::vector<double> mList;
    std::vector<std::uint32_t> mPolygon;
    PolygonTriangulator mTriangulator;
};

} // namespace

Result<TriangleMesh> readPly(std::string_view bytes, ReadJob& job) {
    PlyHeader header;
    if (!readPlyHeader(bytes, job, header))
        return job.takeError();
    switch (header.encoding) {
    case PlyEncoding::Ascii:
        return BodyReader<TextSource>(bytes, header, job).read();
    case PlyEncoding::LittleEndian:
        return BodyReader<BinarySource<std::endian::little>>(bytes, header, job).read();
    case PlyEncoding::BigEndian:
        return BodyReader<BinarySource<std::endian::big>>(bytes, header, job).read();
    }
    return job.takeError();
}

} // namespace lamina::detail
