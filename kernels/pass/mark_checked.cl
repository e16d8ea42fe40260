// Of the pixels in which no more rays were cast than one, marks one in CHECKED_OF to be cast next, picked by their numbers'
// hash: what many rays show there says how much the others may differ. With KIND only pixels that met something: the
// others are proven to show nothing.
//
// Reads cast and kind. Writes cast.
#include "lib/ray/marks.clh"

#if WITH_KIND
#define SEEN_KIND , const global uint *kind
#else
#define SEEN_KIND
#endif

// Every bit of the number moves every bit of the hash (Wellons 2018, lowbias32).
static inline uint hash_of(uint n)
{
    n ^= n >> 16;
    n *= 0x7feb352du;
    n ^= n >> 15;
    n *= 0x846ca68bu;
    return n ^ n >> 16;
}

kernel void mark_checked(RayGrid rays SEEN_KIND, global uint *cast)
{
    uint i = (uint)get_global_id(0);
    uint j = (uint)get_global_id(1);
    if (i >= rays.width || j >= rays.height)
        return;
    uint pixel = j * rays.width + i;
    if (cast[pixel] != MARK_FILLED || hash_of(pixel) % CHECKED_OF != 0u)
        return;
#if WITH_KIND
    if (kind[pixel] == KIND_NOTHING)
        return;
#endif
    cast[pixel] = MARK_NEXT;
}
