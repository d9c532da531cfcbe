#include "mesh_io/index_table.hpp"
#include "mesh_io/mesh_readers.hpp"
#include "mesh_io/polygon_triangulator.hpp"
#include "mesh_io/text_lines.hpp"

#include <algorithm>
#include <array>
#include <span>

namespace lamina::detail {
namespace {

/// Statements that carry no triangles: attributes of appearance, names, points, lines, free-form
/// curves and surfaces.
constexpr std::array<std::string_view, 42> kSkippedStatements = {
    "g",    "o",          "s",      "mg",  "usemtl",   "mtllib",  "usemap", "maplib",   "vp",
    "l",    "p",          "bevel",  "lod", "c_interp", "call",    "csh",    "d_interp", "trace_obj",
    "bmat", "step",       "cstype", "deg", "curv",     "curv2",   "surf",   "parm",     "trim",
    "hole", "scrv",       "sp",     "end", "con",      "ctech",   "stech",  "res",      "bsp",
    "bzp",  "shadow_obj", "cdc",    "cdp", "group",    "material"};

class ObjReader {
public:
    ObjReader(std::string_view text, ReadJob& job)
        : mLines(text)
        , mJob(job) {}

    Result<TriangleMesh> read() {
        while (mLines.nextJoined())
            if (!mJob.advance(mLines.position()) || !readStatement())
                return mJob.takeError();
        return finish();
    }

private:
    [[nodiscard]] SourceLocation here() const { return atLine(mLines.number()); }

    bool readStatement() {
        Words words(mLines.line());
        const std::string_view keyword = words.next();
        if (keyword == "v")
            return readVertex(words);
        if (keyword == "f")
            return readFace(words);
        if (keyword == "vn")
            return readNormal(words);
        if (keyword == "vt") {
            ++mTextureCount;
            return true;
        }
        if (keyword.empty() || keyword[0] == '#' ||
            std::find(kSkippedStatements.begin(), kSkippedStatements.end(), keyword) !=
                kSkippedStatements.end())
            return true;
        return mJob.fail(here(), "an OBJ statement (v, vn, vt, f, ...)", quoted(keyword));
    }

    /// Reads up to `values.size()` numbers; the count, or nothing if a word is no number.
    std::optional<std::size_t> readNumbers(Words& words, std::span<float> values,
                                           std::string_view what) {
        std::size_t count = 0;
        for (; count < values.size(); ++count) {
            const std::string_view word = words.next();
            if (word.empty() || word[0] == '#')
                return count;
            const std::optional<float> value = parseReal<float>(word);
            if (!value) {
                mJob.fail(here(), what, quoted(word));
                return std::nullopt;
            }
            values[count] = *value;
        }
        const std::string_view extra = words.next();
        if (extra.empty() || extra[0] == '#')
            return count;
        mJob.fail(here(), what, quoted(extra) + " after " + std::to_string(count) + " numbers");
        return std::nullopt;
    }

    bool readVertex(Words& words) {
        std::array<float, 7> n{};
        const std::optional<std::size_t> count = readNumbers(words, n, "3 coordinates");
        if (!count)
            return false;
        if (*count < 3 || *count == 5)
            return mJob.fail(here(), "3 coordinates (and optionally a weight or a colour)",
                             std::to_string(*count) + " numbers");
        if (mMesh.positions.size() == kMaxVertexCount)
            return mJob.fail(here(), "fewer than 2^32 vertices", "more");
        const glm::vec3 position(n[0], n[1], n[2]);
        mNonFinite.check(mMesh.positions.size(), position, here());
        if (*count >= 6 && mMesh.colors.size() < mMesh.positions.size())
            mMesh.colors.resize(mMesh.positions.size(), glm::vec4(1.0f));
        mMesh.positions.push_back(position);
        if (*count >= 6)
            mMesh.colors.emplace_back(unitRange(n[3]), unitRange(n[4]), unitRange(n[5]),
                                      *count == 7 ? unitRange(n[6]) : 1.0f);
        return true;
    }

    bool readNormal(Words& words) {
        std::array<float, 3> n{};
        const std::optional<std::size_t> count = readNumbers(words, n, "a normal of 3 numbers");
        if (!count)
            return false;
        if (*count < 3)
            return mJob.fail(here(), "a normal of 3 numbers", std::to_string(*count));
        mNormals.emplace_back(n[0], n[1], n[2]);
        return true;
    }

    /// One index of a face corner, from 1 or relative to the end of `count` items; result from 0.
    bool readIndex(std::string_view word, std::size_t count, IndexCheck& check,
                   std::uint32_t& index) {
        const std::optional<std::int64_t> value = parseInteger<std::int64_t>(word);
        if (!value)
            return mJob.fail(here(), "a face corner like 1, 1/1, 1//1 or 1/1/1", quoted(word));
        const auto items = static_cast<std::int64_t>(count);
        const std::int64_t absolute = *value < 0 ? items + *value : *value - 1;
        if (absolute < 0 || absolute >= static_cast<std::int64_t>(kMaxVertexCount)) {
            const std::string expected = *value < 0
                                             ? "a relative index down to -" + std::to_string(items)
                                             : std::string("an index from 1 to 2^32 - 1");
            return mJob.fail(
                readError(ErrorCode::InvalidMesh, here(), expected, std::string(quoted(word))));
        }
        if (absolute >= items)
            check.note(static_cast<std::uint64_t>(absolute), here());
        index = static_cast<std::uint32_t>(absolute);
        return true;
    }

    bool readCorner(std::string_view word) {
        const std::size_t slash = std::min(word.find('/'), word.size());
        std::uint32_t vertex = 0;
        if (!readIndex(word.substr(0, slash), mMesh.positions.size(), mVertexCheck, vertex))
            return false;
        mPolygon.push_back(vertex);
        if (slash == word.size()) {
            mAllHaveNormals = false;
            return true;
        }
        const std::string_view rest = word.substr(slash + 1);
        const std::size_t second = std::min(rest.find('/'), rest.size());
        const std::string_view texture = rest.substr(0, second);
        std::uint32_t ignored = 0;
        if ((second == rest.size() || !texture.empty()) &&
            !readIndex(texture, mTextureCount, mTextureCheck, ignored))
            return false;
        if (second == rest.size()) {
            mAllHaveNormals = false;
            return true;
        }
        std::uint32_t normal = 0;
        if (!readIndex(rest.substr(second + 1), mNormals.size(), mNormalCheck, normal))
            return false;
        mPolygonNormals.push_back(normal);
        return true;
    }

    bool readFace(Words& words) {
        mPolygon.clear();
        mPolygonNormals.clear();
        for (std::string_view word = words.next(); !word.empty() && word[0] != '#';
             word = words.next())
            if (!readCorner(word))
                return false;
        if (mPolygon.size() < 3)
            return mJob.fail(here(), "a face of at least 3 corners",
                             std::to_string(mPolygon.size()));
        const std::size_t first = mMesh.triangles.size();
        mTriangulator.append(mMesh.positions, mPolygon, mMesh.triangles);
        const std::span added = std::span(mMesh.triangles).subspan(first);
        if (mAllHaveNormals) {
            mTriangleNormals.insert(mTriangleNormals.end(), added.begin(), added.end());
            lookUp(std::span(mTriangleNormals).subspan(first), mPolygonNormals);
        }
        lookUp(added, mPolygon);
        return true;
    }

    Result<TriangleMesh> finish() {
        if (const auto checked = mVertexCheck.resolve(mMesh.positions.size(), 1, "vertex");
            !checked)
            return checked.error();
        if (const auto checked = mTextureCheck.resolve(mTextureCount, 1, "texture coordinate");
            !checked)
            return checked.error();
        if (const auto checked = mNormalCheck.resolve(mNormals.size(), 1, "normal"); !checked)
            return checked.error();
        if (const auto checked = mNonFinite.resolve(mMesh); !checked)
            return checked.error();
        if (!mMesh.colors.empty())
            mMesh.colors.resize(mMesh.positions.size(), glm::vec4(1.0f));
        if (mAllHaveNormals && !mMesh.triangles.empty() && !splitByNormals())
            return mJob.takeError();
        return std::move(mMesh);
    }

    /// Makes one vertex of each pair of position and normal that a corner names.
    bool splitByNormals() {
        constexpr std::uint32_t kNone = 0xFFFFFFFFu;
        const std::size_t positionCount = mMesh.positions.size();
        std::vector<std::uint32_t> normalOf(positionCount, kNone);
        struct Pair {
            std::uint32_t position, normal;
            bool operator==(const Pair&) const = default;
        };
        std::vector<Pair> added;
        IndexTable table;
        for (std::size_t i = 0; i < mMesh.triangles.size(); ++i)
            for (int corner = 0; corner < 3; ++corner) {
                const Pair pair{mMesh.triangles[i][corner], mTriangleNormals[i][corner]};
                std::uint32_t& first = normalOf[pair.position];
                if (first == kNone)
                    first = pair.normal;
                if (first == pair.normal)
                    continue;
                const auto fresh = static_cast<std::uint32_t>(added.size());
                const std::uint32_t place = table.findOrInsert(
                    mixBits(std::uint64_t{pair.position} << 32u | pair.normal), fresh,
                    [&](std::uint32_t other) { return added[other] == pair; });
                if (place == fresh)
                    added.push_back(pair);
                if (positionCount + place >= kMaxVertexCount)
                    return mJob.fail(here(), "fewer than 2^32 pairs of position and normal",
                                     "more");
                mMesh.triangles[i][corner] = static_cast<std::uint32_t>(positionCount + place);
            }

        mMesh.normals.reserve(positionCount + added.size());
        for (const std::uint32_t normal : normalOf)
            mMesh.normals.push_back(normal == kNone ? glm::vec3(0.0f) : mNormals[normal]);
        for (const Pair& pair : added) {
            const glm::vec3 position = mMesh.positions[pair.position];
            mMesh.positions.push_back(position);
            mMesh.normals.push_back(mNormals[pair.normal]);
            if (!mMesh.colors.empty()) {
                const glm::vec4 color = mMesh.colors[pair.position];
                mMesh.colors.push_back(color);
            }
        }
        return true;
    }

    TextLines mLines;
    ReadJob& mJob;
    TriangleMesh mMesh;
    NonFiniteVertices mNonFinite;
    std::vector<glm::vec3> mNormals;
    std::size_t mTextureCount = 0;
    IndexCheck mVertexCheck, mTextureCheck, mNormalCheck;

    bool mAllHaveNormals = true;
    std::vector<glm::uvec3>
        mTriangleNormals; ///< As mMesh.triangles; stops growing at the first corner without.
    std::vector<std::uint32_t> mPolygon, mPolygonNormals;
    PolygonTriangulator mTriangulator;
};

} // namespace

Result<TriangleMesh> readObj(std::string_view text, ReadJob& job) {
    return ObjReader(text, job).read();
}

} // namespace lamina::detail
