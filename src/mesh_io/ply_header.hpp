#pragma once

#include "mesh_io/read_support.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lamina::detail {

enum class PlyEncoding : std::uint8_t { Ascii, LittleEndian, BigEndian };
enum class PlyType : std::uint8_t { Int8, UInt8, Int16, UInt16, Int32, UInt32, Float, Double };

[[nodiscard]] constexpr std::size_t plyTypeBytes(PlyType type) {
    constexpr std::size_t kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return kBytes[static_cast<std::size_t>(type)];
}

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::Float; ///< Of the value, or of a list's items.
    bool isList = false;
    PlyType countType = PlyType::UInt8; ///< Lists only.
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
    std::uint64_t line = 0; ///< Where the header declares it.

    [[nodiscard]] bool hasLists() const;
    /// The fewest bytes that one of them takes in the file; a row of text includes its line end.
    [[nodiscard]] std::size_t minBytes(PlyEncoding encoding) const;
};

struct PlyHeader {
    PlyEncoding encoding = PlyEncoding::Ascii;
    std::vector<PlyElement> elements;
    std::size_t bodyOffset = 0;      ///< Bytes.
    std::uint64_t bodyFirstLine = 0; ///< For text.
};

/// Reads the header of a PLY file. False, with job's error set, if it is not one.
[[nodiscard]] bool readPlyHeader(std::string_view bytes, ReadJob& job, PlyHeader& header);

} // namespace lamina::detail
