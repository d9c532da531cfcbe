"""Reads a voxel file with a reader that is not Lamina's and compares all of it.

usage: check_grid.py FILE OCCUPANCY NX NY NZ LOWX LOWY LOWZ EDGEX EDGEY EDGEZ [UP [COLORS NORMALS]]

OCCUPANCY: NX*NY*NZ bytes, 0 or 1, x fastest, then y, then z. COLORS: four bytes, RGBA, for each of these;
NORMALS: three floats. Both are zero where a voxel has none.
Exit code 0: equal; 1: a difference, said on standard output; 77: the reader is not installed.
"""
import struct
import sys

try:
    import numpy as np
except ImportError as error:
    print(error)
    sys.exit(77)


def fail(text):
    print(text)
    sys.exit(1)


def expect_close(what, found, expected):
    if not np.allclose(found, expected, rtol=1e-9, atol=1e-12):
        fail(f"{what}: expected {expected}, found {found}")


def expect_equal(what, found, expected):
    if found.shape != expected.shape or found.dtype != expected.dtype:
        fail(f"{what}: expected {expected.shape} {expected.dtype}, found {found.shape} {found.dtype}")
    wrong = np.argwhere(np.any(found != expected, axis=-1))
    if len(wrong):
        fail(f"{what}: {len(wrong)} differ, the first (k, j, i) = {tuple(wrong[0])}: "
             f"expected {expected[tuple(wrong[0])]}, found {found[tuple(wrong[0])]}")


def read_npy(path, low, edge):
    array = np.load(path, allow_pickle=False)
    if array.dtype != np.uint8 or not array.flags["C_CONTIGUOUS"]:
        fail(f"expected a C-ordered uint8 array, found {array.dtype}")
    return array


def check_npy_attributes(path, occupancy, colors, normals):
    """As the documentation says: full[a != 0] = rows."""
    for name, expected in (("color", colors), ("normal", normals)):
        full = np.zeros(expected.shape, dtype=expected.dtype)
        full[occupancy != 0] = np.load(path[: -len(".npy")] + f".{name}.npy", allow_pickle=False)
        expect_equal(name, full, expected)


def check_vti_attributes(path, shape, colors, normals):
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy

    reader = vtk.vtkXMLImageDataReader()
    reader.SetFileName(path)
    reader.Update()
    data = reader.GetOutput().GetCellData()
    for name, expected in (("color", colors), ("normal", normals)):
        array = data.GetArray(name)
        if array is None:
            fail(f"expected the cell array '{name}'")
        expect_equal(name, vtk_to_numpy(array).reshape(expected.shape), expected)


def check_vdb_attributes(path, shape, colors, normals):
    import pyopenvdb as vdb

    for name, expected in (("color", colors[..., :3] / np.float32(255)), ("normal", normals)):
        grid = vdb.read(path, name)
        array = np.zeros(tuple(shape) + (3,), dtype=np.float32)
        grid.copyToArray(array)
        known = np.any(colors != 0, axis=-1) if name == "color" else np.any(normals != 0, axis=-1)
        if grid.activeVoxelCount() != np.count_nonzero(known):
            fail(f"{name}: expected {np.count_nonzero(known)} active voxels, found {grid.activeVoxelCount()}")
        expect_equal(name, array.transpose(2, 1, 0, 3), expected)


def check_vox_attributes(found, colors, occupancy):
    expected = colors[..., :3].copy()
    # Voxels without a colour have the plain one.
    expected[np.all(colors == 0, axis=-1)] = (0xE8, 0x8D, 0x52)
    expected[occupancy == 0] = 0
    different = len(np.unique(expected[occupancy != 0], axis=0))
    if different <= 255:
        expect_equal("palette colours", found, expected)
        return
    used = len(np.unique(found[occupancy != 0], axis=0))
    errors = np.linalg.norm(found.astype(float) - expected.astype(float), axis=-1)[occupancy != 0]
    rms = np.sqrt(np.mean(errors**2))
    print(f"{different} colours as {used}: error {rms:.2f} of 255 (root mean square), at most {errors.max():.1f}")
    # A cube of colours in 255 equal cells has edges of 40 and an error of 20.
    if used != 255 or rms > 20 or errors.max() > 80:
        fail("the palette is a poor one")


def read_vti(path, low, edge):
    try:
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy
    except ImportError as error:
        print(error)
        sys.exit(77)
    reader = vtk.vtkXMLImageDataReader()
    if not reader.CanReadFile(path):
        fail("vtkXMLImageDataReader cannot read the file")
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    expect_close("origin", image.GetOrigin(), low)
    expect_close("spacing", image.GetSpacing(), edge)
    cells = [count - 1 for count in image.GetDimensions()]
    array = image.GetCellData().GetArray("occupancy")
    if array is None or array.GetDataTypeAsString() != "unsigned char":
        fail("expected the uint8 cell array 'occupancy'")
    return vtk_to_numpy(array).reshape(cells[2], cells[1], cells[0])


def read_vdb(path, low, edge, shape, names):
    try:
        import pyopenvdb as vdb
    except ImportError as error:
        print(error)
        sys.exit(77)
    grids, _ = vdb.readAll(path)
    if sorted(grid.name for grid in grids) != sorted(names):
        fail(f"expected the grids {names}, found {[grid.name for grid in grids]}")
    grid = next(grid for grid in grids if grid.name == "density")
    if grid.gridClass != vdb.GridClass.FOG_VOLUME:
        fail("expected 'density' to be a fog volume")
    expect_close("centre of voxel 0", grid.transform.indexToWorld((0, 0, 0)), np.array(low) + 0.5 * np.array(edge))
    expect_close("voxel size", grid.transform.voxelSize(), edge)
    array = np.zeros(shape, dtype=np.float32)
    grid.copyToArray(array)
    if not np.all((array == 0) | (array == 1)):
        fail("expected values 0 and 1")
    if grid.activeVoxelCount() != np.count_nonzero(array):
        fail(f"expected {np.count_nonzero(array)} active voxels, found {grid.activeVoxelCount()}")
    return array.transpose(2, 1, 0).astype(np.uint8)


def read_binvox(path, low, edge):
    """After the format's published description: y runs fastest, then z, then x."""
    with open(path, "rb") as stream:
        if stream.readline() != b"#binvox 1\n":
            fail("expected '#binvox 1'")
        fields = {}
        while (line := stream.readline().split()) != [b"data"]:
            fields[line[0]] = [float(word) for word in line[1:]]
        pairs = np.frombuffer(stream.read(), dtype=np.uint8).reshape(-1, 2)
    depth, height, width = (int(count) for count in fields[b"dim"])
    expect_close("translate", fields[b"translate"], low)
    expect_close("scale", fields[b"scale"][0], edge[0] * max(depth, height, width))
    values = np.repeat(pairs[:, 0], pairs[:, 1])
    return values.reshape(depth, height, width).transpose(1, 2, 0)


def vox_chunks(data):
    position = 0
    while position < len(data):
        kind, content, children = struct.unpack_from("<4sii", data, position)
        yield kind.decode(), data[position + 12 : position + 12 + content]
        if children != 0:
            fail(f"{kind}: expected no child chunks")
        position += 12 + content
    if position != len(data):
        fail("chunks run past the end of the file")


def vox_string(data, position):
    (length,) = struct.unpack_from("<i", data, position)
    return data[position + 4 : position + 4 + length].decode(), position + 4 + length


def vox_dictionary(data, position):
    (count,) = struct.unpack_from("<i", data, position)
    position += 4
    result = {}
    for _ in range(count):
        key, position = vox_string(data, position)
        result[key], position = vox_string(data, position)
    return result, position


def vox_placements(nodes):
    """Walks the scene graph from node 0; yields (model index, translation)."""
    stack = [(0, np.zeros(3, dtype=int))]
    while stack:
        index, offset = stack.pop()
        kind, data = nodes[index]
        _, position = vox_dictionary(data, 4)
        if kind == "nTRN":
            child, _, _, frames = struct.unpack_from("<4i", data, position)
            attributes, end = vox_dictionary(data, position + 16)
            if frames != 1 or end != len(data):
                fail("nTRN: expected one frame")
            move = np.array([int(word) for word in attributes.get("_t", "0 0 0").split()])
            stack.append((child, offset + move))
        elif kind == "nGRP":
            (count,) = struct.unpack_from("<i", data, position)
            stack += [(child, offset) for child in struct.unpack_from(f"<{count}i", data, position + 4)]
        else:
            count, model = struct.unpack_from("<2i", data, position)
            if count != 1:
                fail("nSHP: expected one model")
            yield model, offset


def read_vox(path, shape, up):
    with open(path, "rb") as stream:
        data = stream.read()
    magic, version, main, content, children = struct.unpack_from("<4si4sii", data, 0)
    if (magic, version, main, content, children) != (b"VOX ", 150, b"MAIN", 0, len(data) - 20):
        fail("expected 'VOX ' 150 and one MAIN chunk to the end of the file")
    models, nodes, size, palette = [], {}, None, None
    for kind, chunk in vox_chunks(data[20:]):
        if kind == "SIZE":
            size = np.array(struct.unpack("<3i", chunk))
            if np.any(size < 1) or np.any(size > 256):
                fail(f"SIZE: expected 1 to 256, found {size}")
        elif kind == "XYZI":
            (count,) = struct.unpack_from("<i", chunk, 0)
            voxels = np.frombuffer(chunk, dtype=np.uint8, offset=4).reshape(count, 4).astype(int)
            if np.any(voxels[:, :3] >= size) or np.any(voxels[:, 3] == 0):
                fail("XYZI: a voxel lies outside its model or has colour 0")
            models.append((size, voxels))
        elif kind == "RGBA":
            if len(chunk) != 1024 or chunk[3] != 255:
                fail("RGBA: expected 256 colours, the first one opaque")
            # Colour index i is the file's entry i - 1.
            palette = np.roll(np.frombuffer(chunk, dtype=np.uint8).reshape(256, 4), 1, axis=0)[:, :3].copy()
            palette[0] = 0
        elif kind in ("nTRN", "nGRP", "nSHP"):
            nodes[struct.unpack_from("<i", chunk, 0)[0]] = (kind, chunk)
        else:
            fail(f"unexpected chunk {kind}")
    nx, ny, nz = shape
    turned = {"x": (ny, nz, nx), "y": (nx, nz, ny), "z": (nx, ny, nz)}[up]
    grid = np.zeros(turned, dtype=np.uint8)
    if max(turned) <= 256:
        if nodes or len(models) != 1 or tuple(models[0][0]) != turned:
            fail("expected one model of the grid's size and no scene graph")
        placements = [(0, np.array(turned) // 2)]
    else:
        # The scene stands centred on the origin; move it back to voxel indices.
        origin = np.array([turned[0] // 2, turned[1] // 2, 0])
        placements = [(model, offset + origin) for model, offset in vox_placements(nodes)]
    if sorted(model for model, _ in placements) != list(range(len(models))):
        fail("expected every model to be placed once")
    for model, offset in placements:
        size, voxels = models[model]
        if len(models) > 1 and len(voxels) == 0:
            fail("found an empty model")
        at = voxels[:, :3] + offset - size // 2
        if np.any(grid[at[:, 0], at[:, 1], at[:, 2]]):
            fail("found a voxel twice")
        grid[at[:, 0], at[:, 1], at[:, 2]] = voxels[:, 3]
    # Back to world x, y, z.
    if up == "x":
        grid = grid.transpose(2, 0, 1)
    elif up == "y":
        grid = grid[:, ::-1, :].transpose(0, 2, 1)
    grid = grid.transpose(2, 1, 0)
    return (grid != 0).astype(np.uint8), palette[grid]


def main():
    path, occupancy = sys.argv[1:3]
    shape = [int(word) for word in sys.argv[3:6]]
    low = [float(word) for word in sys.argv[6:9]]
    edge = [float(word) for word in sys.argv[9:12]]
    up = sys.argv[12] if len(sys.argv) > 12 else "y"
    expected = np.fromfile(occupancy, dtype=np.uint8).reshape(shape[::-1])
    colors = normals = None
    if len(sys.argv) > 13:
        colors = np.fromfile(sys.argv[13], dtype=np.uint8).reshape(shape[::-1] + [4])
        normals = np.fromfile(sys.argv[14], dtype=np.float32).reshape(shape[::-1] + [3])
    kind = path.rsplit(".", 1)[1]
    if kind == "vdb":
        found = read_vdb(path, low, edge, shape, ["density"] + (["color", "normal"] if colors is not None else []))
    elif kind == "vox":
        found, painted = read_vox(path, shape, up)
    else:
        found = {"npy": read_npy, "vti": read_vti, "binvox": read_binvox}[kind](path, low, edge)
    if found.shape != expected.shape:
        fail(f"expected shape {expected.shape}, found {found.shape}")
    wrong = np.argwhere(found != expected)
    if len(wrong):
        fail(f"{len(wrong)} voxels differ, the first (k, j, i) = {tuple(wrong[0])}")
    print(f"{expected.sum()} set voxels equal")
    if colors is not None:
        if kind == "vox":
            check_vox_attributes(painted, colors, expected)
        elif kind == "npy":
            check_npy_attributes(path, expected, colors, normals)
        else:
            {"vti": check_vti_attributes, "vdb": check_vdb_attributes}[kind](path, shape, colors, normals)


main()
