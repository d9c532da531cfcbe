#include "mesh_samples.hpp"

#include <lamina/mesh_io/mesh_report.hpp>

#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <new>
#include <random>

namespace {

std::atomic<std::size_t> gHeapBytes{0};
std::atomic<std::size_t> gPeakHeapBytes{0};

void* allocate(std::size_t bytes) {
    void* memory = std::malloc(bytes == 0 ? 1 : bytes);
    if (memory == nullptr)
        throw std::bad_alloc();
    const std::size_t now = gHeapBytes += malloc_usable_size(memory);
    std::size_t peak = gPeakHeapBytes;
    while (peak < now && !gPeakHeapBytes.compare_exchange_weak(peak, now)) {
    }
    return memory;
}

void release(void* memory) {
    if (memory != nullptr)
        gHeapBytes -= malloc_usable_size(memory);
    std::free(memory);
}

} // namespace

void* operator new(std::size_t bytes) {
    return allocate(bytes);
}
void* operator new[](std::size_t bytes) {
    return allocate(bytes);
}
void operator delete(void* memory) noexcept {
    release(memory);
}
void operator delete[](void* memory) noexcept {
    release(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    release(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
    release(memory);
}

namespace lamina {
namespace {

using Random = std::mt19937;

std::size_t below(Random& random, std::size_t limit) {
    return limit == 0 ? 0 : random() % limit;
}

/// A closed shape with more variety than the cube: attributes of every kind a format has.
struct Seed {
    MeshFormat format;
    std::string content;
    bool text;
};

std::vector<Seed> seeds() {
    using namespace samples;
    std::string attributes = "ply\nformat binary_little_endian 1.0\nelement extra 2\n"
                             "property list uchar short a\nelement vertex 4\nproperty double x\n"
                             "property short y\nproperty int z\nproperty uchar red\n"
                             "property uchar green\nproperty uchar blue\nproperty float nx\n"
                             "property float ny\nproperty float nz\nelement tristrips 1\n"
                             "property list int int vertex_indices\nend_header\n";
    for (const std::uint8_t count : {std::uint8_t{2}, std::uint8_t{0}}) {
        append(attributes, count);
        for (int i = 0; i < count; ++i)
            append(attributes, std::int16_t{7});
    }
    for (int i = 0; i < 4; ++i) {
        append(attributes, i * 0.5);
        append(attributes, static_cast<std::int16_t>(i * i));
        append(attributes, std::int32_t{-i});
        attributes += "rgb";
        for (int axis = 0; axis < 3; ++axis)
            append(attributes, 1.0f);
    }
    append(attributes, std::int32_t{5});
    for (const std::int32_t index : {0, 1, 2, 3, -1})
        append(attributes, index);

    const std::string richObj = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 1 1 0.5\nv 3 3 0\n"
                                "vt 0 0\nvt 1 1\nvn 0 0 1\nvn 0 1 0\nf 1/1/1 2/2/1 4/1/2 3/1/2\n"
                                "f -1//1 -2//2 -3//1\nf 1//1 2//1 \\\n 4//2 5//2 3//1\n";
    const std::string richOff =
        "CNOFF\n4 2 0\n0 0 0 0 0 1 255 0 0 255\n1 0 0 0 0 1 0 0 0\n"
        "0 1 0 0 0 1 0 0 0\n1 1 1 0 1 0 9 9 9\n4 0 1 3 2 255 0 0\n3 0 1 2\n";
    return {{MeshFormat::Obj, cubeObj(), true},
            {MeshFormat::Obj, richObj, true},
            {MeshFormat::Off, cubeOff(), true},
            {MeshFormat::Off, richOff, true},
            {MeshFormat::Ply, cubeAsciiPly(), true},
            {MeshFormat::Ply, cubeBinaryPly(std::endian::little), false},
            {MeshFormat::Ply, cubeBinaryPly(std::endian::big), false},
            {MeshFormat::Ply, attributes, false},
            {MeshFormat::Stl, cubeAsciiStl(), true},
            {MeshFormat::Stl, cubeBinaryStl("solid"), false}};
}

constexpr const char* kHostileWords[] = {"nan",         "-1",          "0",
                                         "4294967296",  "2000000000",  "18446744073709551615",
                                         "1e308",       "inf",         "1e-400",
                                         "99999999999", "-2147483648", "",
                                         "/",           "//",          "1//",
                                         "-",           "+",           ".",
                                         "e",           "\\",          "#",
                                         "\r",          "0x7f",        "1.5.5",
                                         "list",        "vertex",      "element",
                                         "f",           "ply",         "255",
                                         "65536",       "3 3 3 3",     "\xEF\xBB\xBF",
                                         "endsolid",    "OFF"};

void replaceWord(std::string& content, Random& random) {
    const std::size_t begin = below(random, content.size());
    const std::size_t start = std::min(content.find_first_not_of(" \n", begin), content.size());
    const std::size_t end = std::min(content.find_first_of(" \n", start), content.size());
    content.replace(start, end - start, kHostileWords[below(random, std::size(kHostileWords))]);
}

std::pair<std::size_t, std::size_t> someLine(const std::string& content, Random& random) {
    const std::size_t at = below(random, content.size());
    const std::size_t before = content.rfind('\n', at);
    const std::size_t begin = before == std::string::npos ? 0 : before + 1;
    const std::size_t after = content.find('\n', at);
    const std::size_t end = after == std::string::npos ? content.size() : after + 1;
    return {std::min(begin, end), end};
}

void mutate(std::string& content, bool text, Random& random) {
    if (content.empty())
        return;
    const auto [begin, end] = someLine(content, random);
    switch (below(random, text ? 9 : 7)) {
    case 0:
        content.resize(below(random, content.size()));
        break;
    case 1:
        content[below(random, content.size())] = static_cast<char>(random());
        break;
    case 2:
        content[below(random, content.size())] ^= static_cast<char>(1u << below(random, 8));
        break;
    case 3: {
        constexpr std::uint32_t kValues[] = {0xFFFFFFFFu, 0x7FFFFFFFu, 0x80000000u, 0x7F800000u,
                                             0u};
        const std::uint32_t value = kValues[below(random, std::size(kValues))];
        const std::size_t at = below(random, content.size());
        std::memcpy(content.data() + at, &value, std::min<std::size_t>(4, content.size() - at));
        break;
    }
    case 4: {
        const std::size_t at = below(random, content.size());
        content.erase(at, below(random, 40));
        break;
    }
    case 5: {
        std::string piece = content.substr(below(random, content.size()), below(random, 200));
        content.insert(below(random, content.size()), piece);
        break;
    }
    case 6:
        replaceWord(content, random);
        break;
    case 7:
        content.erase(begin, end - begin);
        break;
    default: {
        const std::string line = content.substr(begin, end - begin);
        const std::size_t times = below(random, 8) == 0 ? 2000 : 1;
        std::string copies;
        for (std::size_t i = 0; i < times; ++i)
            copies += line;
        content.insert(begin, copies);
    }
    }
}

bool isUnit(const glm::vec3& v) {
    return std::abs(std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z) - 1.0f) < 1e-3f;
}

/// 10,000, or what LAMINA_FUZZ_FILES says, for a longer search.
int fileCount() {
    const char* wanted = std::getenv("LAMINA_FUZZ_FILES");
    return wanted != nullptr ? std::atoi(wanted) : 10'000;
}

TEST(MeshFuzz, TenThousandMutatedFiles) {
    const int files = fileCount();
    Random random(20250101);
    const std::vector<Seed> all = seeds();
    for (const Seed& seed : all) {
        const auto intact = samples::parse(seed.content, seed.format);
        ASSERT_TRUE(intact) << intact.error().text;
    }
    std::size_t accepted = 0;
    double worstSeconds = 0, worstMemory = 0;
    for (int i = 0; i < files; ++i) {
        const Seed& seed = all[static_cast<std::size_t>(i) % all.size()];
        std::string content = seed.content;
        for (std::size_t times = 1 + below(random, 3); times > 0; --times)
            mutate(content, seed.text, random);

        // Without spare capacity, so that sanitizers see a read past the end.
        const std::vector<char> exact(content.begin(), content.end());
        const MeshFormat format = i % 3 == 0 ? MeshFormat::Automatic : seed.format;
        const std::size_t heapBefore = gHeapBytes;
        gPeakHeapBytes = heapBefore;
        const auto start = std::chrono::steady_clock::now();
        const Result<TriangleMesh> mesh = samples::parse({exact.data(), exact.size()}, format);
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        const auto used = static_cast<double>(gPeakHeapBytes - heapBefore);

        ASSERT_LT(took.count(), 5.0) << i;
        // The promise of readMesh(), and a page for what does not depend on the file.
        ASSERT_LT(used, 64.0 * static_cast<double>(content.size()) + 8192) << i;
        worstSeconds = std::max(worstSeconds, took.count());
        worstMemory = std::max(worstMemory, used);
        if (!mesh) {
            ASSERT_NE(mesh.error().text.find("expected"), std::string::npos) << mesh.error().text;
            continue;
        }
        ++accepted;
        const Result<void> valid = validate(*mesh);
        ASSERT_TRUE(valid) << i << ": " << valid.error().text;
        ASSERT_EQ(mesh->normals.size(), mesh->positions.size()) << i;
        ASSERT_TRUE(std::all_of(mesh->normals.begin(), mesh->normals.end(), isUnit)) << i;
        ASSERT_TRUE(inspect(*mesh)) << i;
    }
    std::cout << accepted << " of " << files << " files were still meshes; at worst "
              << worstSeconds << " s, " << worstMemory / 1024 << " KiB\n";
    // Mutations that only ever fail, or never do, would test little.
    EXPECT_GT(accepted, static_cast<std::size_t>(files) / 20);
    EXPECT_LT(accepted, static_cast<std::size_t>(files) / 2);
}

/// Files made to cost as much as they can per byte.
TEST(MeshFuzz, DenseFilesStayWithinTheMemoryPromise) {
    using samples::replaced;
    const std::string header = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 1 0\n";
    std::string fan = header + "f";
    std::string normals = header + "f";
    for (int i = 0; i < 500'000; ++i) {
        fan += i % 2 == 0 ? " 1" : " 2";
        normals += i % 2 == 0 ? " 1//1" : " 2//2";
    }
    std::string points = header;
    std::string pairs = header;
    for (int i = 0; i < 100'000; ++i) {
        points += "v 1 1 1\n";
        pairs += "vn 1 0 0\nf 1//-1 2//-1 3//-1\n";
    }
    std::string ply =
        "ply\nformat binary_little_endian 1.0\nelement vertex 200000\nproperty uchar x\n"
        "property uchar y\nproperty uchar z\nelement face 200000\n"
        "property list uchar uchar vertex_index\nend_header\n";
    ply += std::string(600'000, '\1');
    for (int i = 0; i < 200'000; ++i)
        ply += std::string("\3\0\1\2", 4);
    std::string polygon = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n500000";
    for (int i = 0; i < 500'000; ++i)
        polygon += i % 2 == 0 ? " 0" : " 1";
    std::string strip = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty uchar x\n"
                        "property uchar y\nproperty uchar z\nelement tristrips 1\n"
                        "property list uint uchar vertex_indices\nend_header\nabcdefghi";
    samples::append(strip, std::uint32_t{600'000});
    for (int i = 0; i < 600'000; ++i)
        strip += static_cast<char>(i % 3);

    const std::string polygonHeader =
        replaced(strip.substr(0, strip.find("end_header")), "tristrips 1", "face ");
    std::string onePolygon = replaced(polygonHeader, "face ", "face 1") + "end_header\nabcbca000";
    samples::append(onePolygon, std::uint32_t{600'000});
    for (int i = 0; i < 600'000; ++i)
        onePolygon += static_cast<char>(i % 3);
    std::string polygons =
        replaced(replaced(polygonHeader, "face ", "face 3000"), "uint", "uchar") +
        "end_header\nabcbca000";
    for (int i = 0; i < 3000; ++i) {
        polygons += '\xFF';
        for (int corner = 0; corner < 255; ++corner)
            polygons += static_cast<char>(corner % 3);
    }

    for (const std::string* content :
         {&fan, &normals, &points, &pairs, &ply, &polygon, &strip, &onePolygon, &polygons}) {
        const std::size_t before = gHeapBytes;
        gPeakHeapBytes = before;
        const auto start = std::chrono::steady_clock::now();
        const Result<TriangleMesh> mesh = samples::parse(*content, MeshFormat::Automatic);
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        const double factor =
            static_cast<double>(gPeakHeapBytes - before) / static_cast<double>(content->size());
        std::cout << content->size() << " bytes: " << factor << " bytes a byte, " << took.count()
                  << " s" << (mesh ? "" : ": " + mesh.error().text) << "\n";
        EXPECT_LT(factor, 64.0);
        EXPECT_LT(took.count(), 5.0);
    }
}

} // namespace
} // namespace lamina
