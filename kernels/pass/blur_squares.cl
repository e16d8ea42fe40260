// How far discs reach (lib/ray/blur.clh) in each square of BLURRED_SQUARE x BLURRED_SQUARE pixels. A work-item takes a square.
//
// Reads circle and cover. Writes squares, row by row.
#include "lib/ray/blur.clh"

#if BLURRED_SQUARE != 8
#error "a row of a square is read as eight numbers"
#endif

static inline float least_of_row(float8 a)
{
    float4 four = a.lo < a.hi ? a.lo : a.hi;
    float2 two = four.lo < four.hi ? four.lo : four.hi;
    return two.x < two.y ? two.x : two.y;
}

static inline float greatest_of_row(float8 a) { return -least_of_row(-a); }

static inline bool any_of_eight(int8 mask)
{
    int4 four = mask.lo | mask.hi;
    int2 two = four.lo | four.hi;
    return (two.x | two.y) != 0;
}

// Adds the pixels of a square, from (i, j) on.
static inline void add_pixels(BlurredSquare *square, RayGrid rays, int i, int j, const global float *circle, const global float *cover)
{
    int i_end = min(i + BLURRED_SQUARE, (int)rays.width);
    int j_end = min(j + BLURRED_SQUARE, (int)rays.height);
    if (i_end - i == BLURRED_SQUARE && j_end - j == BLURRED_SQUARE) {
        float8 nearest = (float8)(square->nearest);
        float8 farthest = (float8)(square->farthest);
        int8 unseen = (int8)(0);
        for (int y = j; y < j_end; y++) {
            float8 diameter = vload8(0, circle + (y * (int)rays.width + i));
            int8 seen = vload8(0, cover + (y * (int)rays.width + i)) > 0.0f;
            nearest = seen && diameter < nearest ? diameter : nearest;
            farthest = seen && diameter > farthest ? diameter : farthest;
            unseen |= !seen;
        }
        square->nearest = least_of_row(nearest);
        square->farthest = greatest_of_row(farthest);
        square->uneven = square->uneven || any_of_eight(unseen);
        return;
    }
    for (int y = j; y < j_end; y++)
        for (int x = i; x < i_end; x++) {
            int place = y * (int)rays.width + x;
            bool seen = cover[place] > 0.0f;
            float diameter = circle[place];
            square->nearest = seen && diameter < square->nearest ? diameter : square->nearest;
            square->farthest = seen && diameter > square->farthest ? diameter : square->farthest;
            square->uneven = square->uneven || !seen;
        }
}

kernel void blur_squares(RayGrid rays, const global float *circle, const global float *cover, global float4 *squares)
{
    int i = (int)(get_global_id(0) * BLURRED_SQUARE);
    int j = (int)(get_global_id(1) * BLURRED_SQUARE);
    if (i >= (int)rays.width || j >= (int)rays.height)
        return;
    uint squares_across = squares_in_row(rays);
    BlurredSquare square = {0.0f, INFINITY, -INFINITY, false};
    add_pixels(&square, rays, i, j, circle, cover);
    square.reach = square.nearest <= square.farthest ? 0.5f * max(-square.nearest, square.farthest) : 0.0f;
    squares[get_global_id(1) * squares_across + get_global_id(0)] = square_numbers(square);
}
