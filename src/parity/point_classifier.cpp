#include "core/check_enumeration.hpp"
#include "gl/binding_guards.hpp"
#include "gl/program_cache.hpp"
#include "gl/state_guard.hpp"
#include "parity/parity_constants.hpp"
#include "parity/parity_errors.hpp"

#include <lamina/parity/point_classifier.hpp>

#include <algorithm>
#include <array>
#include <string>

namespace lamina {
namespace {

constexpr const char* kOperation = "point classification";
constexpr std::uint64_t kPointBytes = sizeof(glm::vec3);
/// A batch ends between two words of every kind of answer.
constexpr std::uint64_t kBatchStep = 32;
/// The limit of GL_MAX_COMPUTE_WORK_GROUP_COUNT that every device has.
constexpr std::uint64_t kMaxGroups = 65535;
constexpr std::uint64_t kMaxBatch = std::uint64_t{1} << 24u;

std::uint64_t pointsPerWord(PointAnswer answer) {
    switch (answer) {
    case PointAnswer::Bits:
        return 32;
    case PointAnswer::Masks:
        return 1;
    case PointAnswer::Bytes:
    case PointAnswer::Classes:
        break;
    }
    return 4;
}

const char* answerName(PointAnswer answer) {
    switch (answer) {
    case PointAnswer::Bits:
        return "LAMINA_PARITY_ANSWER_BITS";
    case PointAnswer::Bytes:
        return "LAMINA_PARITY_ANSWER_BYTES";
    case PointAnswer::Classes:
        return "LAMINA_PARITY_ANSWER_CLASSES";
    case PointAnswer::Masks:
        break;
    }
    return "LAMINA_PARITY_ANSWER_MASKS";
}

GLuint ruleNumber(SpriteRule rule) {
    switch (rule) {
    case SpriteRule::Intersection:
        return LAMINA_PARITY_INTERSECTION;
    case SpriteRule::Difference:
        return LAMINA_PARITY_DIFFERENCE;
    case SpriteRule::Union:
        break;
    }
    return LAMINA_PARITY_UNION;
}

Error invalid(const std::string& text) {
    return {ErrorCode::InvalidArgument, "point classification: expected " + text};
}

/// An error of an allocation, with the advice for points.
Error ownError(const Error& error) {
    return detail::inWordsOf(kOperation, "use fewer points", error);
}

/// Are all values those of their enumerations?
Result<void> checkValues(const PointQuery& query) {
    if (auto valid = checkEnumeration(kOperation, "PointAnswer", query.answer, PointAnswer::Masks);
        !valid)
        return valid;
    return checkEnumeration(kOperation, "SpriteRule", query.rule, SpriteRule::Difference);
}

Result<void> checkDirections(const SpriteSet& sprites, const PointQuery& query) {
    if (query.directions > 0 &&
        (query.answer == PointAnswer::Classes || sprites.size() % query.directions != 0))
        return invalid("directions that divide the set, and no classes with them, found " +
                       std::to_string(query.directions) + " directions and " +
                       std::to_string(sprites.size()) + " sprites");
    return {};
}

/// A part of a buffer, bound from an aligned place on.
struct BoundRange {
    GLintptr begin = 0;
    GLsizeiptr size = 0;
    std::uint32_t firstWord = 0;

    BoundRange(std::uint64_t offset, std::uint64_t bytes, std::uint64_t alignment)
        : begin(static_cast<GLintptr>(offset / alignment * alignment))
        , size(static_cast<GLsizeiptr>(offset % alignment + bytes))
        , firstWord(static_cast<std::uint32_t>(offset % alignment / 4)) {}
};

} // namespace

struct PointClassifier::Impl {
    std::shared_ptr<gl::DeviceState> device;
    gl::Buffer constants;

    [[nodiscard]] Result<void> check(const PointBuffer& points, std::uint32_t answers,
                                     std::uint64_t offset, std::uint64_t bytes) const;
    [[nodiscard]] Result<std::uint64_t> batchSize(const PointBuffer& points) const;
    [[nodiscard]] Result<GLuint> program(const SpriteSet& sprites, const PointQuery& query) const;
    void dispatch(const PointBuffer& points, std::uint64_t first, std::uint64_t count,
                  const PointQuery& query, GLuint answers, std::uint64_t answerOffset);
};

Result<void> PointClassifier::Impl::check(const PointBuffer& points, std::uint32_t answers,
                                          std::uint64_t offset, std::uint64_t bytes) const {
    const GladGLContext& gl = device->gl;
    const auto sizeOf = [&](GLuint buffer) {
        GLint64 size = 0;
        gl.GetNamedBufferParameteri64v(buffer, GL_BUFFER_SIZE, &size);
        return static_cast<std::uint64_t>(size);
    };
    if (!gl.IsBuffer(points.buffer) || !gl.IsBuffer(answers))
        return invalid("GL buffers of points and answers, found names " +
                       std::to_string(points.buffer) + " and " + std::to_string(answers));
    if (points.offsetBytes % 4 != 0 || points.strideBytes % 4 != 0 ||
        points.strideBytes < kPointBytes || offset % 4 != 0)
        return invalid("offsets and a stride in multiples of 4 bytes, the stride at least 12, "
                       "found point offset " +
                       std::to_string(points.offsetBytes) + ", stride " +
                       std::to_string(points.strideBytes) + ", answer offset " +
                       std::to_string(offset));
    const std::uint64_t pointSpace = sizeOf(points.buffer);
    const bool fits =
        pointSpace >= kPointBytes && points.offsetBytes <= pointSpace - kPointBytes &&
        points.count - 1 <= (pointSpace - kPointBytes - points.offsetBytes) / points.strideBytes;
    if (!fits)
        return invalid("a buffer that holds " + std::to_string(points.count) +
                       " points, found one of " + std::to_string(pointSpace) + " bytes");
    if (const std::uint64_t space = sizeOf(answers); offset > space || bytes > space - offset)
        return invalid("a buffer with " + std::to_string(bytes) +
                       " bytes for the answers from byte " + std::to_string(offset) +
                       " on, found one of " + std::to_string(space) + " bytes");
    return {};
}

Result<std::uint64_t> PointClassifier::Impl::batchSize(const PointBuffer& points) const {
    const std::uint64_t space =
        device->limits.maxStorageBlockBytes - device->limits.storageBufferOffsetAlignment;
    // Masks take four bytes a point.
    const std::uint64_t reach =
        std::min({(space - kPointBytes) / points.strideBytes, space / 4, kMaxBatch});
    if (reach < kBatchStep)
        return Error{ErrorCode::DeviceLimit,
                     "point classification: expected points less than " +
                         std::to_string(space / kBatchStep) + " bytes apart, found a stride of " +
                         std::to_string(points.strideBytes) + "; repack them"};
    return reach / kBatchStep * kBatchStep;
}

Result<GLuint> PointClassifier::Impl::program(const SpriteSet& sprites,
                                              const PointQuery& query) const {
    // Those that the build compiles.
    const char* count = sprites.size() <= 1 ? "1" : sprites.size() <= 4 ? "4" : "32";
    return gl::findOrBuildProgram(*device,
                                  {"lamina point classification",
                                   {{GL_COMPUTE_SHADER, "parity/points.comp"}},
                                   {{"LAMINA_PARITY_ANSWER", answerName(query.answer)},
                                    {"LAMINA_PARITY_REFINED", query.directions > 0 ? "1" : "0"},
                                    {"LAMINA_PARITY_COUNT", count}}});
}

void PointClassifier::Impl::dispatch(const PointBuffer& points, std::uint64_t first,
                                     std::uint64_t count, const PointQuery& query, GLuint answers,
                                     std::uint64_t answerOffset) {
    const GladGLContext& gl = device->gl;
    const std::uint64_t alignment = device->limits.storageBufferOffsetAlignment;
    const BoundRange input(points.offsetBytes + first * points.strideBytes,
                           (count - 1) * points.strideBytes + kPointBytes, alignment);
    const std::uint64_t perWord = pointsPerWord(query.answer);
    const std::uint64_t words = (count + perWord - 1) / perWord;
    const BoundRange output(answerOffset + first / perWord * 4, words * 4, alignment);

    const shared::LaminaPointConstants block{
        {input.firstWord, points.strideBytes / 4, count, output.firstWord},
        {ruleNumber(query.rule), std::max(query.directions, 1u), 0, 0}};
    // New storage each time: the last dispatch may still read the old.
    gl.NamedBufferData(constants.id(), sizeof block, &block, GL_STREAM_DRAW);
    const GLuint uniforms = constants.id();
    gl.BindBuffersBase(GL_UNIFORM_BUFFER, LAMINA_PARITY_POINT_BLOCK_BINDING, 1, &uniforms);
    const std::array<GLuint, 2> buffers{points.buffer, answers};
    const std::array<GLintptr, 2> begins{input.begin, output.begin};
    const std::array<GLsizeiptr, 2> sizes{input.size, output.size};
    static_assert(LAMINA_PARITY_POINT_OUTPUT_BINDING == LAMINA_PARITY_POINT_INPUT_BINDING + 1);
    gl.BindBuffersRange(GL_SHADER_STORAGE_BUFFER, LAMINA_PARITY_POINT_INPUT_BINDING, 2,
                        buffers.data(), begins.data(), sizes.data());
    const std::uint64_t groups =
        (words + LAMINA_PARITY_POINT_GROUP - 1) / LAMINA_PARITY_POINT_GROUP;
    gl.DispatchCompute(static_cast<GLuint>(std::min(groups, kMaxGroups)),
                       static_cast<GLuint>((groups + kMaxGroups - 1) / kMaxGroups), 1);
}

PointClassifier::PointClassifier(std::unique_ptr<Impl> impl)
    : mImpl(std::move(impl)) {}
PointClassifier::PointClassifier(PointClassifier&&) noexcept = default;
PointClassifier& PointClassifier::operator=(PointClassifier&&) noexcept = default;
PointClassifier::~PointClassifier() = default;

Result<PointClassifier> PointClassifier::create(const Device& device) {
    auto impl = std::make_unique<Impl>();
    impl->device = device.state();
    impl->constants = gl::Buffer::create(impl->device, "lamina point constants");
    return PointClassifier(std::move(impl));
}

std::uint64_t PointClassifier::answerBytes(PointAnswer answer, std::uint64_t count) {
    const std::uint64_t perWord = pointsPerWord(answer);
    return (count / perWord + (count % perWord != 0 ? 1 : 0)) * 4;
}

Result<void> PointClassifier::classify(const SpriteSet& sprites, const PointBuffer& points,
                                       const PointQuery& query, std::uint32_t answers,
                                       std::uint64_t answerOffset) {
    if (auto valid = checkValues(query); !valid)
        return valid;
    if (points.count == 0)
        return {};
    if (const auto outdated = sprites.outdatedSprite())
        return invalid("the sprites that the set was given, found that sprite " +
                       std::to_string(*outdated) +
                       " was rebuilt or destroyed; call SpriteSet::update()");
    if (auto divides = checkDirections(sprites, query); !divides)
        return divides;
    auto valid =
        mImpl->check(points, answers, answerOffset, answerBytes(query.answer, points.count));
    if (!valid)
        return valid;
    auto batch = mImpl->batchSize(points);
    if (!batch)
        return batch.error();
    auto program = mImpl->program(sprites, query);
    if (!program)
        return program.error();
    const gl::DebugGroup group(*mImpl->device, "lamina: classify points");
    const gl::ComputeStateGuard guard(*mImpl->device, 2, 2);
    const gl::TextureUnitGuard textures(*mImpl->device, 0, sprites.size());
    mImpl->device->gl.UseProgram(*program);
    sprites.bind(LAMINA_PARITY_POINT_SET_BINDING, 0);
    for (std::uint64_t first = 0; first < points.count; first += *batch)
        mImpl->dispatch(points, first, std::min(*batch, points.count - first), query, answers,
                        answerOffset);
    return {};
}

Result<std::vector<std::uint8_t>> PointClassifier::download(const SpriteSet& sprites,
                                                            std::span<const glm::vec3> points,
                                                            const PointQuery& query) {
    if (auto valid = checkValues(query); !valid)
        return valid.error();
    std::vector<std::uint8_t> answers(answerBytes(query.answer, points.size()));
    if (points.empty())
        return answers;
    auto input = gl::createBuffer(mImpl->device, points.size_bytes(), points.data(), 0, kOperation,
                                  "lamina points");
    if (!input)
        return ownError(input.error());
    auto output = gl::createBuffer(mImpl->device, answers.size(), nullptr, 0, kOperation,
                                   "lamina point answers");
    if (!output)
        return ownError(output.error());
    PointBuffer buffer;
    buffer.buffer = input->id();
    buffer.count = points.size();
    if (auto done = classify(sprites, buffer, query, output->id()); !done)
        return done.error();
    const GladGLContext& gl = mImpl->device->gl;
    gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    gl.GetNamedBufferSubData(output->id(), 0, static_cast<GLsizeiptr>(answers.size()),
                             answers.data());
    return answers;
}

} // namespace lamina
