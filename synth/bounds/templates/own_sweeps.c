/* What stands between the tightening of one register, which is generated, and that of a block. */

INLINE void begin_file(const Batch *b, vd *file) {}

static void tighten(const Batch *b, const Whole *whole, vd *file, Registers *block, int wide, vi *dead) {
    for (int w = 0; w < wide; w++) dead[w] = tighten_one(b, whole, block + w);
}
