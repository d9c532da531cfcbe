// The volume integral of [ED06] 3.3: how many voxels of a column lie inside a closed surface, from the
// voxels that its front and its back faces set.
//
// Rules. Slice 0 is nearest the eye. A voxel with front faces alone counts and one with back faces alone
// does not: on average each holds half a slice inside. The last voxel that is not empty counts always,
// since a column's near/far range ends at its last crossing. An ambiguous voxel, with faces of both kinds,
// counts. Empty voxels count if the ray is inside: after a front voxel it is, after a back voxel it is not, and after
// an ambiguous one the next voxel that is not empty decides: a back voxel ends a run of inside voxels, a
// front or another ambiguous one does not. Before the first and after the last voxel that is not empty
// the ray is outside.
//
// Words are fed in order, from the eye: 32 slices by laminaIntegralAdd(), 128 by laminaIntegralAdd128(),
// or 8 of the evaluation table by laminaIntegralAddEntry(). All give the same numbers on every input,
// also on that of surfaces that are not closed.
#ifndef LAMINA_VOLUME_INTEGRAL_GLSL
#define LAMINA_VOLUME_INTEGRAL_GLSL

#include <lamina/shared/refraction_block.glsl>

#define LAMINA_INTEGRAL_STATE_OUTSIDE 0
#define LAMINA_INTEGRAL_STATE_INSIDE 1
#define LAMINA_INTEGRAL_STATE_AMBIGUOUS 2

// A column's integral up to some slice.
struct LaminaIntegral {
    int count;        // Inner voxels, without the last one's due.
    int state;        // Of the ray behind the last voxel that is not empty.
    int run;          // Empty voxels after it.
    bool isEmpty;     // No voxel yet.
    bool startsInside; // The first voxel has back faces alone: the surface is not closed.
    bool isAmbiguous; // Some voxel has faces of both kinds.
};

LaminaIntegral laminaIntegralBegin() {
    return LaminaIntegral(0, LAMINA_INTEGRAL_STATE_OUTSIDE, 0, true, false, false);
}

// Of the bits of `empty`, those in runs that begin, upwards, at a bit of `starts`, each of which must be
// the lowest bit of a run: adding it carries through the run and clears it.
uint laminaRunsFrom(uint empty, uint starts) {
    return empty & ~(empty + (starts & empty));
}

// Settles the empty voxels before a voxel that is not empty; `isBack`: it has back faces alone. Gives
// whether the ray was inside before it.
bool laminaIntegralSettle(inout LaminaIntegral integral, bool isBack) {
    bool isInside = integral.state == LAMINA_INTEGRAL_STATE_INSIDE ||
                    (integral.state == LAMINA_INTEGRAL_STATE_AMBIGUOUS && isBack);
    integral.count += isInside ? integral.run : 0;
    integral.startsInside = integral.startsInside || (integral.isEmpty && isBack);
    integral.isEmpty = false;
    return isInside;
}

// The next `bits` slices (1 to 32): masks of front and back voxels, slice 0 in bit 0, no bit beyond.
void laminaIntegralAdd(inout LaminaIntegral integral, uint front, uint back, int bits) {
    uint full = front | back;
    if (full == 0u) {
        integral.run += bits;
        return;
    }
    uint lowest = full & (~full + 1u);
    bool isInside = laminaIntegralSettle(integral, (back & ~front & lowest) != 0u);
    uint empty = ~full;
    uint both = front & back;
    // After a front voxel: upwards. Runs at the top of the word wait for what follows.
    uint waiting = findMSB(full) == 31 ? 0u : ~(0xffffffffu >> uint(31 - findMSB(full)));
    uint inner = laminaRunsFrom(empty, (front & ~back) << 1 | (isInside ? 1u : 0u));
    // After an ambiguous voxel and before a back voxel: upwards from the one, downwards from the other.
    uint after = laminaRunsFrom(empty, both << 1);
    uint before = bitfieldReverse(laminaRunsFrom(bitfieldReverse(empty), bitfieldReverse(back & ~front) << 1));
    inner = (inner | (after & before)) & ~waiting;
    integral.count += bitCount(front | inner);
    uint highest = 1u << uint(findMSB(full));
    integral.state = (both & highest) != 0u    ? LAMINA_INTEGRAL_STATE_AMBIGUOUS
                     : (front & highest) != 0u ? LAMINA_INTEGRAL_STATE_INSIDE
                                               : LAMINA_INTEGRAL_STATE_OUTSIDE;
    integral.run = bits - 1 - findMSB(full);
    integral.isAmbiguous = integral.isAmbiguous || both != 0u;
}

// The next 128 slices.
void laminaIntegralAdd128(inout LaminaIntegral integral, uvec4 front, uvec4 back) {
    laminaIntegralAdd(integral, front.x, back.x, 32);
    laminaIntegralAdd(integral, front.y, back.y, 32);
    laminaIntegralAdd(integral, front.z, back.z, 32);
    laminaIntegralAdd(integral, front.w, back.w, 32);
}

// Inner voxels of the column, once all its slices are added.
int laminaIntegralCount(LaminaIntegral integral) {
    bool endsAtBack = !integral.isEmpty && integral.state == LAMINA_INTEGRAL_STATE_OUTSIDE;
    return integral.count + (endsAtBack ? 1 : 0);
}

// Does the column look like one of a closed surface, entered before it is left?
bool laminaIntegralIsClosed(LaminaIntegral integral) {
    return !integral.startsInside && integral.state != LAMINA_INTEGRAL_STATE_INSIDE;
}

// A column's integral by the evaluation table, up to some slice. Empty voxels are counted as they come:
// those after the last voxel that is not empty are taken back at the end.
struct LaminaTableIntegral {
    int count;
    bool isInside;
    int pending;  // If not 0: the last voxel that is not empty is ambiguous; one plus the empty ones after it.
    int trailing; // Empty voxels after the last that is not.
    bool isEmpty; // No voxel yet.
};

LaminaTableIntegral laminaTableIntegralBegin() {
    return LaminaTableIntegral(0, false, 0, 0, true);
}

// The next 8 slices: the table's entry for their pair of masks, its channels times 255, and the masks.
// r: voxels inside if the ray enters inside, plus LAMINA_INTEGRAL_INSIDE if it then leaves inside; g: the
// same if it enters outside; b: is the first voxel that is not empty a back voxel?; a: if the last one is
// ambiguous, one plus the empty voxels after it.
void laminaIntegralAddEntry(inout LaminaTableIntegral integral, ivec4 entry, uint front, uint back) {
    uint full = front | back;
    bool isEmpty = full == 0u;
    // What an ambiguous voxel left open is decided by the first voxel that is not empty.
    bool enters = integral.pending != 0 ? !isEmpty && entry.b != 0 : integral.isInside;
    if (integral.pending != 0 && !isEmpty) {
        integral.count += entry.b != 0 ? integral.pending - 1 : 0;
        integral.pending = 0;
    }
    int chosen = enters ? entry.r : entry.g;
    integral.count += chosen & (LAMINA_INTEGRAL_INSIDE - 1);
    integral.isInside = chosen >= LAMINA_INTEGRAL_INSIDE;
    if (isEmpty) {
        integral.pending += integral.pending != 0 ? 8 : 0;
        integral.trailing += 8;
    } else {
        integral.pending = entry.a;
        integral.trailing = 7 - findMSB(full);
        integral.isEmpty = false;
    }
}

// Inner voxels of the column, once all its slices are added.
int laminaIntegralCount(LaminaTableIntegral integral) {
    if (integral.isInside)
        return integral.count - integral.trailing;
    bool endsAtBack = !integral.isEmpty && integral.pending == 0;
    return integral.count + (endsAtBack ? 1 : 0);
}

#endif
