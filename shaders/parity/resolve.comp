// Finishes a sprite: sorts each column's layers, closes what is open, and reports.
//
// One invocation owns one column:
//   1. its number of crossings is known from the passes before; add it to the report. Atomic: all
//      columns add to it;
//   2. LAMINA_PARITY_SORTED 0: sort the gathered layers in place, a few by insertion, many by a heap,
//      so that 2048 layers stay below 65,535 steps;
//   3. an odd number of crossings: the shape is open there. It is taken to begin at the near depth, as
//      Coverage::Solid does: a layer at depth 0 comes first;
//   4. layers without a crossing say so. Columns with more crossings than layers become empty;
//   5. the group, a block of columns, leaves its ranges in the texture's last layer. Atomic: its columns
//      narrow them together.
// LAMINA_PARITY_LAYERED 0: only the report.
// permute LAMINA_PARITY_LAYERED = 0 1
// permute LAMINA_PARITY_SORTED = 0 1
#include <lamina/shared/parity_block.glsl>

layout(local_size_x = LAMINA_PARITY_RESOLVE_GROUP, local_size_y = LAMINA_PARITY_RESOLVE_GROUP) in;

layout(binding = LAMINA_PARITY_COUNT_IMAGE, r32ui) uniform readonly uimage2D laminaCounts;
layout(binding = LAMINA_PARITY_LAYER_IMAGE, r32f) uniform image2DArray laminaLayers;

layout(std430, binding = LAMINA_PARITY_REPORT_BINDING) buffer LaminaReportBlock {
    LaminaSpriteReport laminaReport;
};

shared uint groupLayers;
shared uint groupOdd;
shared uint groupOverflow;
shared uint groupCrossings;
#if LAMINA_PARITY_LAYERED
// Depths are not negative: their bits are ordered as they are.
shared uint groupRanges[LAMINA_PARITY_RANGES];
shared uint groupFilled; // Columns that are not empty.
#endif

ivec2 column = ivec2(gl_GlobalInvocationID.xy);

float layerAt(int layer) {
    return imageLoad(laminaLayers, ivec3(column, layer)).r;
}

void setLayer(int layer, float depth) {
    imageStore(laminaLayers, ivec3(column, layer), vec4(depth));
}

// Makes room for `depth` among the sorted layers [0, count) and puts it there.
void insertLayer(float depth, int count) {
    int place = count;
    while (place > 0) {
        float nearer = layerAt(place - 1);
        if (nearer <= depth)
            break;
        setLayer(place, nearer);
        --place;
    }
    setLayer(place, depth);
}

// Puts `depth` into the heap [0, count), whose root is free, the greatest at the root.
void siftDown(float depth, int root, int count) {
    int place = root;
    for (int child = 2 * place + 1; child < count; child = 2 * place + 1) {
        float greater = layerAt(child);
        if (child + 1 < count) {
            float other = layerAt(child + 1);
            if (other > greater) {
                greater = other;
                ++child;
            }
        }
        if (greater <= depth)
            break;
        setLayer(place, greater);
        place = child;
    }
    setLayer(place, depth);
}

void sortLayers(int count) {
    if (count <= LAMINA_PARITY_INSERTION_LAYERS) {
        for (int i = 1; i < count; ++i)
            insertLayer(layerAt(i), i);
        return;
    }
    for (int root = count / 2 - 1; root >= 0; --root)
        siftDown(layerAt(root), root, count);
    for (int last = count - 1; last > 0; --last) {
        float depth = layerAt(last);
        setLayer(last, layerAt(0));
        siftDown(depth, 0, last);
    }
}

#if LAMINA_PARITY_LAYERED
// Layers of the column in use are [0, used), an even number.
void narrowRanges(int used) {
    if (used == 0)
        return;
    uint first = floatBitsToUint(layerAt(0));
    atomicAdd(groupFilled, 1u);
    atomicMin(groupRanges[LAMINA_PARITY_FIRST], first);
    atomicMax(groupRanges[LAMINA_PARITY_LAST], floatBitsToUint(layerAt(used - 1)));
    atomicMax(groupRanges[LAMINA_PARITY_ENTER], first);
    atomicMin(groupRanges[LAMINA_PARITY_LEAVE], floatBitsToUint(layerAt(1)));
}

// By the first invocations of the group, when its columns are done.
void storeRanges() {
    int range = int(gl_LocalInvocationIndex);
    ivec2 block = ivec2(gl_WorkGroupID.xy);
    ivec2 texel = 2 * block + ivec2(range & 1, range >> 1);
    ivec3 size = imageSize(laminaLayers);
    if (range >= LAMINA_PARITY_RANGES || any(greaterThanEqual(texel, size.xy)))
        return;
    ivec2 columns = min(size.xy - LAMINA_PARITY_BLOCK * block, ivec2(LAMINA_PARITY_BLOCK));
    bool isNowhereInside = range == LAMINA_PARITY_LEAVE && int(groupFilled) < columns.x * columns.y;
    float value = isNowhereInside ? 0.0 : uintBitsToFloat(groupRanges[range]);
    imageStore(laminaLayers, ivec3(texel, size.z - 1), vec4(value));
}
#endif

// Returns the number of layers in use.
int resolveColumn(int crossings, int layers) {
    int used = crossings;
    if (crossings > layers) {
        used = 0;
    } else {
#if !LAMINA_PARITY_SORTED
        sortLayers(crossings);
#endif
        if ((crossings & 1) != 0) {
            insertLayer(0.0, crossings);
            ++used;
        }
    }
    for (int layer = used; layer < layers; ++layer)
        setLayer(layer, LAMINA_PARITY_NO_LAYER);
    return used;
}

void main() {
    if (gl_LocalInvocationIndex == 0u) {
        groupLayers = 0u;
        groupOdd = 0u;
        groupOverflow = 0u;
        groupCrossings = 0u;
#if LAMINA_PARITY_LAYERED
        groupRanges[LAMINA_PARITY_FIRST] = floatBitsToUint(LAMINA_PARITY_NO_LAYER);
        groupRanges[LAMINA_PARITY_LAST] = 0u;
        groupRanges[LAMINA_PARITY_ENTER] = 0u;
        groupRanges[LAMINA_PARITY_LEAVE] = floatBitsToUint(LAMINA_PARITY_NO_LAYER);
        groupFilled = 0u;
#endif
    }
    barrier();
    if (all(lessThan(column, imageSize(laminaCounts)))) {
        uint crossings = imageLoad(laminaCounts, column).r;
        if (crossings != 0u) {
            atomicMax(groupLayers, crossings + (crossings & 1u));
            atomicAdd(groupOdd, crossings & 1u);
            atomicAdd(groupCrossings, crossings);
        }
#if LAMINA_PARITY_LAYERED
        int layers = imageSize(laminaLayers).z - 1;
        if (crossings > uint(layers))
            atomicAdd(groupOverflow, 1u);
        narrowRanges(resolveColumn(int(crossings), layers));
#endif
    }
    // The group's numbers are complete.
    barrier();
#if LAMINA_PARITY_LAYERED
    storeRanges();
#endif
    if (gl_LocalInvocationIndex != 0u || groupCrossings == 0u)
        return;
    atomicMax(laminaReport.layers, groupLayers);
    atomicAdd(laminaReport.oddColumns, groupOdd);
    atomicAdd(laminaReport.overflowColumns, groupOverflow);
    uint before = atomicAdd(laminaReport.crossingsLow, groupCrossings);
    if (before + groupCrossings < before)
        atomicAdd(laminaReport.crossingsHigh, 1u);
}
