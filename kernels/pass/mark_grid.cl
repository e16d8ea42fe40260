// Gives the pixels of a grid whose spacing is in pixels a mark: the crossings of its lines, the last column and the last
// row among them. The others become MARK_FILLED.
//
// Writes cast.
#include "lib/ray/blocks.clh"

kernel void mark_grid(RayGrid rays, uint spacing, uint mark, global uint *cast)
{
    Pixels pixels = tile_pixels(rays);
    Mask crossing = on_grid_line(pixels.i, spacing, rays.width) & on_grid_line(pixels.j, spacing, rays.height);
    Ints marks = crossing ? INTS((int)mark) : INTS((int)MARK_FILLED);
    SCATTER(pixels.inside, cast, pixels.index, marks);
}
