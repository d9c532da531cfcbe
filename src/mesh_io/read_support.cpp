#include "mesh_io/read_support.hpp"

namespace lamina::detail {

Error readError(ErrorCode code, SourceLocation where, std::string_view expected,
                std::string_view found) {
    std::string text = where.unit == SourceLocation::Unit::Line ? "line " : "byte ";
    text += std::to_string(where.number);
    text.append(": expected ").append(expected).append(", found ").append(found);
    return {code, std::move(text)};
}

std::string quoted(std::string_view text) {
    constexpr std::size_t kLongest = 40;
    std::string result = "'";
    for (const char c : text.substr(0, kLongest))
        result += c >= ' ' && c <= '~' ? c : '?';
    result += text.size() > kLongest ? "...'" : "'";
    return result;
}

bool ReadJob::report(std::size_t bytesDone) {
    constexpr std::size_t kBytesPerReport = std::size_t{1} << 20u;
    mNextReport = bytesDone + kBytesPerReport;
    const double total = mTotalBytes > 0 ? static_cast<double>(mTotalBytes) : 1.0;
    if (mProgress(static_cast<float>(static_cast<double>(bytesDone) / total)))
        return true;
    return fail({ErrorCode::Cancelled, "cancelled by the progress callback after " +
                                           std::to_string(bytesDone) + " of " +
                                           std::to_string(mTotalBytes) + " bytes"});
}

Result<void> NonFiniteVertices::resolve(TriangleMesh& mesh) const {
    if (mEntries.empty())
        return {};
    for (const glm::uvec3& triangle : mesh.triangles)
        for (int corner = 0; corner < 3; ++corner) {
            const glm::vec3& p = mesh.positions[triangle[corner]];
            if (isFinite(p))
                continue;
            SourceLocation where;
            for (const Entry& entry : mEntries)
                if (entry.vertex == triangle[corner])
                    where = entry.where;
            return readError(ErrorCode::InvalidMesh, where, "finite vertex coordinates",
                             "a non-finite vertex (" + std::to_string(p.x) + ", " +
                                 std::to_string(p.y) + ", " + std::to_string(p.z) +
                                 ") that a triangle uses; remove or repair it");
        }
    for (const Entry& entry : mEntries)
        mesh.positions[entry.vertex] = glm::vec3(0.0f);
    return {};
}

Result<void> IndexCheck::resolve(std::uint64_t count, std::uint64_t base,
                                 std::string_view what) const {
    if (!mSeen || mLargest < count)
        return {};
    std::string expected(what);
    expected += count == 0 ? " indices only where the file has such vertices"
                           : " indices up to " + std::to_string(count - 1 + base);
    return readError(ErrorCode::InvalidMesh, mWhere, expected, std::to_string(mLargest + base));
}

} // namespace lamina::detail
