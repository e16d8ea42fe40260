// What reaches each square of pixels (lib/ray/blur.clh): of the squares around whose discs reach it the greatest radius, the
// nearest and the farthest circle; and whether there is anything uneven no more than `reach_px` pixels away. A work-item takes a
// square.
//
// Reads squares, row by row, and looks at so many as `reach_px` spans. Writes reaches.
#include "lib/ray/blur.clh"

// Pixels from one square to another so many squares away, along an axis.
static inline int gap_px(int away)
{
    int squares = abs(away) - 1;
    return squares < 0 ? 0 : squares * BLURRED_SQUARE + 1;
}

kernel void blur_reach(RayGrid rays, float reach_px, const global float4 *squares, global float4 *reaches)
{
    int across = (int)squares_in_row(rays);
    int down = (int)((rays.height + BLURRED_SQUARE - 1u) / BLURRED_SQUARE);
    int i = (int)get_global_id(0);
    int j = (int)get_global_id(1);
    if (i >= across || j >= down)
        return;
    int span = (int)(reach_px / (float)BLURRED_SQUARE) + 1;
    BlurredSquare found = {0.0f, INFINITY, -INFINITY, false};
    float nearest = INFINITY;
    float farthest = -INFINITY;
    for (int y = max(j - span, 0); y <= min(j + span, down - 1); y++)
        for (int x = max(i - span, 0); x <= min(i + span, across - 1); x++) {
            BlurredSquare square = blurred_square(squares[y * across + x]);
            int across_px = gap_px(x - i);
            int down_px = gap_px(y - j);
            float apart = (float)(across_px * across_px + down_px * down_px);
            float reach = square.reach + 0.5f;
            bool reaches = apart < reach * reach;
            found.reach = reaches ? max(found.reach, square.reach) : found.reach;
            found.nearest = reaches ? min(found.nearest, square.nearest) : found.nearest;
            found.farthest = reaches ? max(found.farthest, square.farthest) : found.farthest;
            bool near = apart < (reach_px + 0.5f) * (reach_px + 0.5f);
            found.uneven = found.uneven || (near && square.uneven);
            nearest = near ? min(nearest, square.nearest) : nearest;
            farthest = near ? max(farthest, square.farthest) : farthest;
        }
    found.uneven = found.uneven || farthest - nearest > APART_PX;
    reaches[j * across + i] = square_numbers(found);
}
