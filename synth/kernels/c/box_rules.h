/* Made by `make kernels`; edits are lost. */
static __attribute__((noinline)) Interval forward_103(Interval a, Interval b) { return i_mul(a, b); }
static __attribute__((noinline)) Interval forward_104(Interval a, Interval b) { return i_mul(a, i_inv(b)); }
static __attribute__((noinline)) Interval forward_111(Interval a) { return i_sq(a); }
static __attribute__((noinline)) Interval forward_136(Interval a) { return i_inv(a); }
static __attribute__((noinline)) Interval forward_129(Interval a) { return i_abs(a); }
static __attribute__((noinline)) Interval forward_113(Interval a) { return wave(a, v_sin(a.low), v_sin(a.high), 1.5707963267948966); }
static __attribute__((noinline)) Interval forward_114(Interval a) { return wave(a, v_cos(a.low), v_cos(a.high), 0.0); }
static __attribute__((noinline)) Interval forward_115(Interval a) { return where(v_floor(a.low / 3.141592653589793 + 0.5) == v_floor(a.high / 3.141592653589793 + 0.5), both(v_tan(a.low), v_tan(a.high)), unknown()); }
static __attribute__((noinline)) Interval forward_138(Interval a) { return both(v_cosh(i_abs(a).low), v_cosh(i_abs(a).high)); }
static __attribute__((noinline)) Interval forward_195(Interval a, Interval b) { return both(v_hypot(i_abs(a).low, i_abs(b).low), v_hypot(i_abs(a).high, i_abs(b).high)); }
static __attribute__((noinline)) Interval forward_143(Interval a, Interval b) { return where(b.low > 0.0, both(v_atan(i_mul(a, i_inv(b)).low), v_atan(i_mul(a, i_inv(b)).high)), both(all(-3.141592653589793), all(3.141592653589793))); }
static __attribute__((noinline)) Interval forward_121(Interval a, Interval b) { return equality(a, b); }
static __attribute__((noinline)) Interval forward_122(Interval a, Interval b) { return both(1.0 - equality(a, b).high, 1.0 - equality(a, b).low); }
static __attribute__((noinline)) Interval forward_power_constant(Interval a, Interval b) { return i_power(a, b.low[0]); }
static __attribute__((noinline)) Interval forward_power_any(Interval a, Interval b) { return i_any_power(a, b); }
static __attribute__((noinline)) Interval backward_101_0(Interval r, Interval b) { return widened(both(r.low - b.high, r.high - b.low), r, b); }
static __attribute__((noinline)) Interval backward_101_1(Interval r, Interval a) { return widened(both(r.low - a.high, r.high - a.low), r, a); }
static __attribute__((noinline)) Interval backward_102_0(Interval r, Interval b) { return widened(both(r.low + b.low, r.high + b.high), r, b); }
static __attribute__((noinline)) Interval backward_102_1(Interval r, Interval a) { return widened(both(a.low - r.high, a.high - r.low), r, a); }
static __attribute__((noinline)) Interval backward_103_0(Interval r, Interval b) { return i_quotient(r, b); }
static __attribute__((noinline)) Interval backward_103_1(Interval r, Interval a) { return i_quotient(r, a); }
static __attribute__((noinline)) Interval backward_104_0(Interval r, Interval b) { return i_mul(r, b); }
static __attribute__((noinline)) Interval backward_104_1(Interval r, Interval a) { return i_quotient(a, r); }
static __attribute__((noinline)) Interval backward_136_0(Interval r) { return i_quotient(both(all(1.0), all(1.0)), r); }
static __attribute__((noinline)) Interval backward_106_0(Interval r) { return both(v_log(v_max(blurred(r).low, all(0.0))), v_log(v_max(blurred(r).high, all(0.0)))); }
static __attribute__((noinline)) Interval backward_194_0(Interval r) { return both(v_log1p(v_max(blurred(r).low, all(-1.0))), v_log1p(v_max(blurred(r).high, all(-1.0)))); }
static __attribute__((noinline)) Interval backward_power(Interval r, Interval a, Interval b) { return where((a.low >= 0.0) & (b.low != 0.0), i_power(both(v_max(r.low, all(0.0)), v_max(r.high, all(0.0))), 1.0 / b.low[0]), nothing()); }
