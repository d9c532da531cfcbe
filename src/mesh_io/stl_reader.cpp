#include "mesh_io/mesh_readers.hpp"
#include "mesh_io/text_lines.hpp"
#include "mesh_io/vertex_welder.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace lamina::detail {
namespace {

constexpr std::size_t kHeaderBytes = 84;   ///< 80 of text, then the number of triangles.
constexpr std::size_t kTriangleBytes = 50; ///< Normal, three corners, two bytes of attributes.

std::uint32_t littleEndian32(const char* bytes) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes, sizeof value);
    if constexpr (std::endian::native == std::endian::big)
        value = __builtin_bswap32(value);
    return value;
}

std::uint64_t binarySize(std::string_view bytes) {
    return kHeaderBytes + std::uint64_t{littleEndian32(bytes.data() + 80)} * kTriangleBytes;
}

bool equalIgnoringCase(std::string_view word, std::string_view lowerCase) {
    return std::equal(word.begin(), word.end(), lowerCase.begin(), lowerCase.end(),
                      [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a + 32 : a) == b; });
}

/// Text starts with "solid" and holds no control characters other than blanks and line ends.
bool looksLikeText(std::string_view bytes) {
    if (bytes.starts_with("\xEF\xBB\xBF"))
        bytes.remove_prefix(3);
    const std::size_t start = std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size());
    if (!equalIgnoringCase(bytes.substr(start, 5), "solid"))
        return false;
    const std::string_view begin = bytes.substr(0, 512);
    return std::none_of(begin.begin(), begin.end(), [](char c) {
        return static_cast<unsigned char>(c) < 32 && !isBlank(c) && c != '\r' && c != '\n';
    });
}

Result<TriangleMesh> readBinary(std::string_view bytes, ReadJob& job) {
    if (bytes.size() < kHeaderBytes)
        return readError(ErrorCode::InvalidFile, atByte(bytes.size()),
                         "an 84-byte binary STL header or a text that starts with 'solid'",
                         "the end of the file");
    const std::uint32_t count = littleEndian32(bytes.data() + 80);
    if (binarySize(bytes) != bytes.size())
        return readError(ErrorCode::InvalidFile, atByte(80),
                         "a file of " + std::to_string(binarySize(bytes)) + " bytes for " +
                             std::to_string(count) + " triangles",
                         std::to_string(bytes.size()) + " bytes");
    if (count > kMaxVertexCount / 3)
        return readError(ErrorCode::InvalidFile, atByte(80), "fewer than 2^32 vertices",
                         std::to_string(count) + " triangles");
    TriangleMesh mesh;
    mesh.triangles.reserve(count);
    VertexWelder welder;
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::size_t offset = kHeaderBytes + std::size_t{i} * kTriangleBytes;
        if (!job.advance(offset))
            return job.takeError();
        glm::uvec3 triangle;
        for (int corner = 0; corner < 3; ++corner) {
            const std::size_t at = offset + 12 + 12 * static_cast<std::size_t>(corner);
            glm::vec3 p;
            for (int axis = 0; axis < 3; ++axis)
                p[axis] =
                    std::bit_cast<float>(littleEndian32(bytes.data() + at + 4 * std::size_t(axis)));
            if (!isFinite(p))
                return readError(ErrorCode::InvalidMesh, atByte(at), "finite vertex coordinates",
                                 "a non-finite vertex in triangle " + std::to_string(i));
            triangle[corner] = welder.add(p);
        }
        mesh.triangles.push_back(triangle);
    }
    mesh.positions = welder.takePositions();
    return mesh;
}

class AsciiStlReader {
public:
    AsciiStlReader(std::string_view text, ReadJob& job)
        : mLines(text)
        , mJob(job) {}

    Result<TriangleMesh> read() {
        if (!readSolids())
            return mJob.takeError();
        mMesh.positions = mWelder.takePositions();
        return std::move(mMesh);
    }

private:
    [[nodiscard]] SourceLocation here() const { return atLine(mLines.number()); }

    /// The next word, on this line or a later one; empty at the end of the file.
    std::string_view nextWord() {
        while (mWords.atEnd()) {
            if (!mLines.next())
                return {};
            mWords = Words(mLines.line());
        }
        return mWords.next();
    }
    bool unexpected(std::string_view expected, std::string_view word) {
        return mJob.fail(here(), expected, word.empty() ? "the end of the file" : quoted(word));
    }
    bool expect(std::string_view keyword) {
        const std::string_view word = nextWord();
        return equalIgnoringCase(word, keyword) || unexpected(quoted(keyword), word);
    }

    bool readSolids() {
        for (std::string_view word = nextWord(); !word.empty(); word = nextWord()) {
            if (!equalIgnoringCase(word, "solid"))
                return unexpected("'solid'", word);
            mWords = Words(); // the solid's name
            if (!readFacets())
                return false;
        }
        return true;
    }

    bool readFacets() {
        for (std::string_view word = nextWord(); !equalIgnoringCase(word, "endsolid");
             word = nextWord()) {
            if (!equalIgnoringCase(word, "facet"))
                return unexpected("'facet' or 'endsolid'", word);
            if (!mJob.advance(mLines.position()) || !readFacet())
                return false;
        }
        mWords = Words();
        return true;
    }

    bool readFacet() {
        glm::vec3 normal; // degenerate facets often have one of NaN
        if (!expect("normal") || !readVector(normal) || !expect("outer") || !expect("loop"))
            return false;
        glm::uvec3 triangle;
        for (int corner = 0; corner < 3; ++corner) {
            glm::vec3 position;
            if (!expect("vertex") || !readVector(position))
                return false;
            if (!isFinite(position))
                return mJob.fail(readError(ErrorCode::InvalidMesh, here(),
                                           "finite vertex coordinates", "a non-finite vertex"));
            triangle[corner] = mWelder.add(position);
        }
        if (mWelder.positions().size() >= kMaxVertexCount)
            return mJob.fail(here(), "fewer than 2^32 vertices", "more");
        mMesh.triangles.push_back(triangle);
        return expect("endloop") && expect("endfacet");
    }

    bool readVector(glm::vec3& vector) {
        for (int axis = 0; axis < 3; ++axis) {
            const std::string_view word = nextWord();
            const std::optional<float> value = parseReal<float>(word);
            if (!value)
                return unexpected("a number", word);
            vector[axis] = *value;
        }
        return true;
    }

    TextLines mLines;
    Words mWords;
    ReadJob& mJob;
    TriangleMesh mMesh;
    VertexWelder mWelder;
};

} // namespace

bool isBinaryStl(std::string_view bytes) {
    return bytes.size() >= kHeaderBytes && binarySize(bytes) == bytes.size();
}

Result<TriangleMesh> readStl(std::string_view bytes, ReadJob& job) {
    // Binary files that begin with "solid" exist: the size decides first.
    if (!isBinaryStl(bytes) && looksLikeText(bytes))
        return AsciiStlReader(bytes, job).read();
    return readBinary(bytes, job);
}

} // namespace lamina::detail
