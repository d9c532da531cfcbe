#include "help.hpp"

#include <CLI/CLI.hpp>

#include <utility>

namespace lamina::tool {
namespace {

constexpr std::size_t kNameColumns = 32;
constexpr std::size_t kTextColumns = 68;

/// `text` with line breaks between words, no line longer than kTextColumns.
std::string wrapped(std::string text) {
    std::size_t lineStart = 0;
    while (text.size() - lineStart > kTextColumns) {
        const std::size_t space = text.rfind(' ', lineStart + kTextColumns);
        if (space == std::string::npos || space <= lineStart)
            break;
        text[space] = '\n';
        lineStart = space + 1;
    }
    return text;
}

} // namespace

const char* const kHelpDescription =
    R"(Turns a triangle mesh into voxels, on a GPU or by Mesa's software renderer, without a display.
Reads .obj .ply .stl .off; writes .npy .binvox .vox .vti .vdb, and pictures (.png).
)";

const char* const kHelpFooter = R"(Coverage:
  conservative  every voxel that a triangle touches (default); a face on the boundary between two
                voxels sets both
  separating6   a thinner surface without gaps: no path through faces of voxels leads across it
  solid         the inside: voxels whose centre lies inside the mesh, see below
  filled        in each column of voxels whose centre line the triangle crosses, every voxel that it
                spans there; steep surfaces show gaps between columns
  sampled       in each such column only the voxel where the surface meets the centre line; steep
                surfaces show holes
  filled and sampled look along one axis (--axis) and are what an engine's rasterizer makes every
  frame. The default axis is the one along which the triangles cover the most columns.

Solid rules, what is inside:
  parity        an odd number of triangles lies beyond: exact for closed meshes, and fastest; hollow
                where parts overlap; a warning tells of columns where the mesh is not closed
  voted         a majority of 14 rays: for meshes with holes, overlaps, doubled or flipped triangles;
                a warning tells how many voxels were close
  flood         all that the outside cannot reach: up to a voxel thicker; needs no orientation, but
                no opening may be wider than a voxel: a warning tells how much an open mesh
                encloses
  auto takes parity for a watertight mesh of one part and voted for others.

Grid:
  Give one of -r, --voxel-size, or --bounds with --grid. The first two make cubes from the low
  corner of the mesh's box; counts are rounded up. A side that is a whole number of voxels gets no
  extra one: where float coordinates miss it by their rounding, voxels grow by that much. A flat side
  is one voxel thick. --stats tells the bounds and the voxel size in use.
  Lengths are in the mesh's units. Voxel (i, j, k) has its low corner at
  bounds_min + (i, j, k) * voxel_size; in .npy, a uint8 array of shape (NZ, NY, NX), it is a[k][j][i].

Attributes:
  color and normal are means over the surface inside a voxel, weighted by area: of the mesh's vertex
  colours, and of its normals (the faces' own if it has none). .vdb has them as vector grids "color"
  and "normal", .vti as cell arrays, .vox has colours in a palette of 255, .binvox has none. NAME.npy
  gets NAME.color.npy (N x 4, uint8) and NAME.normal.npy (N x 3, float32) beside it, a row for each
  set voxel: full[a != 0] = rows; auto makes none of these. Pictures show colours.
  Inside solids there is no surface: those voxels take the colour of the nearest voxel that has one,
  so that a model cut open in an editor is coloured all through; their normals are zero.

Files:
  All are checked before work starts, and appear whole or not at all. Progress and a summary are
  shown on standard error if that is a terminal.

Exit codes:
  0        done
  1        reading, writing, memory or OpenGL failed
  2        the command line is wrong
  3        the mesh file cannot be read or holds nothing to voxelize
  4        a combination that is not served, or over a limit of device, memory or format
  128 + N  ended by signal N; no partial file is left

Examples:
  lamina-voxelize bunny.obj -o bunny.vdb
  lamina-voxelize bunny.obj -r 512 -o bunny.npy -o bunny.vox --preview bunny.png
  lamina-voxelize part.stl --voxel-size 0.5 --axis z --up z -o part.vti --stats -
  lamina-voxelize room.ply --bounds -4 0 -4 4 3 4 --grid 256 96 256 -o room.binvox
  lamina-voxelize statue.ply -r 256 --attributes color,normal -o statue.vox -o statue.vdb
  lamina-voxelize scan.ply --info
  lamina-voxelize bunny.obj -r 512 --compare
)";

HelpFormatter::HelpFormatter() {
    column_width(kNameColumns);
}

std::string HelpFormatter::make_group(std::string group, bool isPositional,
                                      std::vector<const CLI::Option*> options) const {
    const std::string text =
        Formatter::make_group(std::move(group), isPositional, std::move(options));
    const std::size_t begin = text.find_first_not_of('\n');
    const std::size_t end = text.find_last_not_of('\n') + 1;
    // One blank line after each group; the caller adds it to all but the positionals'.
    return text.substr(begin, end - begin) + (isPositional ? "\n\n" : "\n");
}

std::string HelpFormatter::make_option_opts(const CLI::Option* option) const {
    return option->get_type_size() != 0 ? " " + option->get_type_name() : "";
}

std::string HelpFormatter::make_option_desc(const CLI::Option* option) const {
    return wrapped(option->get_description());
}

std::string HelpFormatter::make_usage(const CLI::App*, std::string name) const {
    return "Usage: " + name + " MESH [OPTIONS]\n\n";
}

} // namespace lamina::tool
