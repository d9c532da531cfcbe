#include "mesh_io/mesh_readers.hpp"
#include "mesh_io/polygon_triangulator.hpp"
#include "mesh_io/text_lines.hpp"

#include <algorithm>
#include <array>

namespace lamina::detail {
namespace {

class OffReader {
public:
    OffReader(std::string_view text, ReadJob& job)
        : mLines(text)
        , mJob(job) {}

    Result<TriangleMesh> read() {
        if (!readHeader() || !readVertices() || !readFaces() || !expectEnd())
            return mJob.takeError();
        if (const auto checked = mNonFinite.resolve(mMesh); !checked)
            return checked.error();
        normalizeColors();
        return std::move(mMesh);
    }

private:
    [[nodiscard]] SourceLocation here() const { return atLine(mLines.number()); }

    bool readHeader() {
        const bool any = mLines.nextContent('#');
        Words words(any ? mLines.line() : std::string_view());
        const std::string_view keyword = words.next();
        if (!readKeyword(keyword))
            return false;
        if (words.atEnd() && mLines.nextContent('#'))
            words = Words(mLines.line());
        return readCounts(words);
    }

    bool readKeyword(std::string_view keyword) {
        std::string_view rest = keyword;
        const auto take = [&rest](std::string_view prefix) {
            const bool found = rest.starts_with(prefix);
            rest.remove_prefix(found ? prefix.size() : 0);
            return found;
        };
        mHaveTexture = take("ST");
        mHaveColors = take("C");
        mHaveNormals = take("N");
        mHaveColors = take("C") || mHaveColors; // NCOFF is written as often as CNOFF
        if (rest == "OFF")
            return true;
        if (rest == "4OFF" || rest == "nOFF" || rest == "4nOFF")
            return mJob.fail(readError(ErrorCode::Unsupported, here(), "3-dimensional vertices",
                                       quoted(keyword)));
        return mJob.fail(here(), "the keyword OFF", quoted(keyword));
    }

    bool readCounts(Words words) {
        std::array<std::uint64_t, 3> counts{};
        for (std::size_t i = 0; i < counts.size(); ++i) {
            const std::string_view word = words.next();
            if (word == "BINARY")
                return mJob.fail(readError(ErrorCode::Unsupported, here(), "a text OFF file",
                                           "BINARY; convert it"));
            const std::optional<std::uint64_t> value = parseInteger<std::uint64_t>(word);
            if (!value && (i < 2 || !word.empty())) // the edge count is often left out
                return mJob.fail(here(), "counts of vertices, faces and edges", quoted(word));
            counts[i] = value.value_or(0);
        }
        if (!words.atEnd())
            return mJob.fail(here(), "counts of vertices, faces and edges", "more numbers");
        mVertexCount = counts[0];
        mFaceCount = counts[1];
        // "0 0 0" is a vertex's shortest line, "3 0 0 0" a face's; the last line end may be
        // missing.
        const std::uint64_t room = mLines.remaining() + 1;
        if (mVertexCount > room / 6 || mFaceCount > room / 8 ||
            mVertexCount * 6 + mFaceCount * 8 > room)
            return mJob.fail(here(),
                             "room for " + std::to_string(mVertexCount) + " vertices and " +
                                 std::to_string(mFaceCount) + " faces",
                             std::to_string(mLines.remaining()) + " bytes");
        if (mVertexCount > kMaxVertexCount)
            return mJob.fail(here(), "fewer than 2^32 vertices", std::to_string(mVertexCount));
        return true;
    }

    bool nextRow(std::string_view what, std::uint64_t index, std::uint64_t count) {
        if (mLines.nextContent('#'))
            return mJob.advance(mLines.position());
        return mJob.fail(here(), std::to_string(count) + " " + std::string(what),
                         "the end of the file after " + std::to_string(index));
    }

    bool readVertices() {
        mMesh.positions.reserve(mVertexCount);
        for (std::uint64_t i = 0; i < mVertexCount; ++i)
            if (!nextRow("vertices", i, mVertexCount) || !readVertex())
                return false;
        return true;
    }

    bool readVertex() {
        std::array<float, 12> n{};
        std::size_t count = 0;
        Words words(mLines.line());
        for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
            const std::optional<float> value = parseReal<float>(word);
            if (!value || count == n.size())
                return mJob.fail(here(), "the numbers of a vertex", quoted(word));
            n[count++] = *value;
        }
        const std::size_t colorAt = mHaveNormals ? 6 : 3;
        const std::size_t fixed = colorAt + (mHaveTexture ? 2 : 0);
        const bool fits = mHaveColors ? count == fixed + 3 || count == fixed + 4 : count == fixed;
        if (!fits)
            return mJob.fail(here(),
                             std::to_string(fixed + (mHaveColors ? 3 : 0)) +
                                 (mHaveColors ? " or one more" : "") + " numbers a vertex",
                             std::to_string(count));
        const glm::vec3 position(n[0], n[1], n[2]);
        mNonFinite.check(mMesh.positions.size(), position, here());
        mMesh.positions.push_back(position);
        if (mHaveNormals)
            mMesh.normals.emplace_back(n[3], n[4], n[5]);
        if (mHaveColors) {
            const bool haveAlpha = count == fixed + 4;
            mMesh.colors.emplace_back(n[colorAt], n[colorAt + 1], n[colorAt + 2],
                                      haveAlpha ? n[colorAt + 3] : -1.0f);
        }
        return true;
    }

    bool readFaces() {
        for (std::uint64_t i = 0; i < mFaceCount; ++i)
            if (!nextRow("faces", i, mFaceCount) || !readFace())
                return false;
        return true;
    }

    bool readFace() {
        Words words(mLines.line());
        const std::string_view countWord = words.next();
        const std::optional<std::uint64_t> count = parseInteger<std::uint64_t>(countWord);
        if (!count || *count < 3)
            return mJob.fail(here(), "a face of at least 3 corners", quoted(countWord));
        mPolygon.clear();
        for (std::uint64_t i = 0; i < *count; ++i) {
            const std::string_view word = words.next();
            if (word.empty())
                return mJob.fail(here(), std::to_string(*count) + " vertex indices",
                                 std::to_string(i));
            const std::optional<std::int64_t> index = parseInteger<std::int64_t>(word);
            if (!index)
                return mJob.fail(here(), "a vertex index", quoted(word));
            if (*index < 0 || static_cast<std::uint64_t>(*index) >= mVertexCount)
                return mJob.fail(
                    readError(ErrorCode::InvalidMesh, here(),
                              "vertex indices from 0 to below " + std::to_string(mVertexCount),
                              std::string(word)));
            mPolygon.push_back(static_cast<std::uint32_t>(*index));
        }
        for (std::string_view word = words.next(); !word.empty(); word = words.next())
            if (!parseReal<float>(word))
                return mJob.fail(here(), "a face colour", quoted(word));
        const std::size_t first = mMesh.triangles.size();
        mTriangulator.append(mMesh.positions, mPolygon, mMesh.triangles);
        lookUp(std::span(mMesh.triangles).subspan(first), mPolygon);
        return true;
    }

    bool expectEnd() {
        return !mLines.nextContent('#') ||
               mJob.fail(here(),
                         "the end of the file after " + std::to_string(mFaceCount) + " faces",
                         quoted(mLines.line()));
    }

    /// Colours are fractions or 0 to 255; one above 1 anywhere tells. Alpha -1 stands for none.
    void normalizeColors() {
        const bool bytes =
            std::any_of(mMesh.colors.begin(), mMesh.colors.end(), [](const glm::vec4& c) {
                return c.x > 1.0f || c.y > 1.0f || c.z > 1.0f || c.w > 1.0f;
            });
        const float one = bytes ? 255.0f : 1.0f;
        for (glm::vec4& c : mMesh.colors) {
            const float alpha = c.w < 0.0f ? 1.0f : unitRange(c.w / one);
            c = {unitRange(c.x / one), unitRange(c.y / one), unitRange(c.z / one), alpha};
        }
    }

    TextLines mLines;
    ReadJob& mJob;
    bool mHaveTexture = false, mHaveColors = false, mHaveNormals = false;
    std::uint64_t mVertexCount = 0, mFaceCount = 0;
    TriangleMesh mMesh;
    NonFiniteVertices mNonFinite;
    std::vector<std::uint32_t> mPolygon;
    PolygonTriangulator mTriangulator;
};

} // namespace

Result<TriangleMesh> readOff(std::string_view text, ReadJob& job) {
    return OffReader(text, job).read();
}

} // namespace lamina::detail
