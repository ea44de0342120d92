/* Registers of double-precision numbers, and elementary functions of them. */

#include <math.h>
#include <string.h>
/* Reading the header of all vector instructions takes as long as compiling a third of the rest: what few there are of
   AVX have names of their own in GCC. */
#ifndef __has_builtin
#define __has_builtin(name) 0
#endif
#if defined(__GNUC__) && !defined(__clang__) && defined(__AVX512F__) && __has_builtin(__builtin_ia32_sqrtpd512_mask) \
    && __has_builtin(__builtin_ia32_maxpd512_mask) && __has_builtin(__builtin_ia32_minpd512_mask) \
    && __has_builtin(__builtin_ia32_cmppd512_mask) && __has_builtin(__builtin_ia32_ptestmq512)
#define AS_ROUNDED 4
#define sqrt_of_eight(a) __builtin_ia32_sqrtpd512_mask(a, a, -1, AS_ROUNDED)
#define max_of_eight(a, known, b) __builtin_ia32_maxpd512_mask(a, b, a, known, AS_ROUNDED)
#define min_of_eight(a, known, b) __builtin_ia32_minpd512_mask(a, b, a, known, AS_ROUNDED)
#define known_of_eight(a) __builtin_ia32_cmppd512_mask(a, a, 7, -1, AS_ROUNDED)
#define any_of_eight(m) (__builtin_ia32_ptestmq512(m, m, -1) != 0)
#elif defined(__GNUC__) && !defined(__clang__) && defined(__AVX__) && !defined(__AVX512F__)
#define sqrt_of_four __builtin_ia32_sqrtpd256
#define max_of_four __builtin_ia32_maxpd256
#define min_of_four __builtin_ia32_minpd256
#define blend_of_four __builtin_ia32_blendvpd256
#elif defined(__AVX512F__) || defined(__AVX__) || defined(__SSE2__)
#include <immintrin.h>
#define sqrt_of_eight(a) _mm512_sqrt_pd((__m512d)(a))
#define max_of_eight(a, known, b) _mm512_mask_max_pd((__m512d)(a), known, (__m512d)(a), (__m512d)(b))
#define min_of_eight(a, known, b) _mm512_mask_min_pd((__m512d)(a), known, (__m512d)(a), (__m512d)(b))
#define known_of_eight(a) _mm512_cmp_pd_mask((__m512d)(a), (__m512d)(a), _CMP_ORD_Q)
#define any_of_eight(m) (_mm512_test_epi64_mask((__m512i)(m), (__m512i)(m)) != 0)
#define sqrt_of_four _mm256_sqrt_pd
#define max_of_four _mm256_max_pd
#define min_of_four _mm256_min_pd
#define blend_of_four _mm256_blendv_pd
#endif
#if defined(__AVX512F__)
#define LANES 8
#elif defined(__AVX__)
#define LANES 4
#else
#define LANES 2
#endif
typedef double vd __attribute__((vector_size(8 * LANES)));
typedef long long vi __attribute__((vector_size(8 * LANES)));
#define INLINE static inline __attribute__((always_inline))

/* Less zero, every number is what it was, minus zero as well. */
INLINE vd all(double x) { return x - (vd){0}; }
INLINE vi all_i(long long x) { return x - (vi){0}; }
/* One instruction in place of three where there is one: all bits of a mask are alike, so that its sign says it. */
INLINE vd choose(vi m, vd a, vd b) {
#if defined(__AVX__) && !defined(__AVX512F__)
    return (vd)blend_of_four(b, a, (vd)m);
#else
    return (vd)((m & (vi)a) | (~m & (vi)b));
#endif
}
INLINE vi choose_i(vi m, vi a, vi b) { return (m & a) | (~m & b); }
INLINE vd keep(vi m, vd a) { return (vd)(m & (vi)a); }
INLINE int any(vi m) {
#if defined(__AVX512F__)
    return any_of_eight(m);
#else
    long long r = 0;
    for (int l = 0; l < LANES; l++) r |= m[l];
    return r != 0;
#endif
}
INLINE vd v_abs(vd a) { return (vd)((vi)a & all_i(0x7fffffffffffffffLL)); }
/* Of a number and not-a-number, not-a-number; of zeros the second. */
INLINE vd v_max(vd a, vd b) {
#if defined(__AVX__) && !defined(__AVX512F__)
    return choose(a != a, a, (vd)max_of_four(a, b));
#else
    return choose((a > b) | (a != a), a, b);
#endif
}
INLINE vd v_min(vd a, vd b) {
#if defined(__AVX__) && !defined(__AVX512F__)
    return choose(a != a, a, (vd)min_of_four(a, b));
#else
    return choose((a < b) | (a != a), a, b);
#endif
}
INLINE vd v_sign(vd a) { return choose(a > 0.0, all(1.0), choose(a < 0.0, all(-1.0), a)); }
INLINE vi is_finite(vd a) { return (a - a) == 0.0; }
INLINE vd v_sqrt(vd a) {
#if defined(__AVX512F__)
    return (vd)sqrt_of_eight(a);
#elif defined(__AVX__)
    return (vd)sqrt_of_four(a);
#elif defined(__SSE2__)
    return (vd)_mm_sqrt_pd((__m128d)a);
#else
    for (int l = 0; l < LANES; l++) a[l] = sqrt(a[l]);
    return a;
#endif
}
#define LANEWISE(name) INLINE vd v_##name(vd a) { for (int l = 0; l < LANES; l++) a[l] = name(a[l]); return a; }
#define LANEWISE2(name) \
    INLINE vd v_##name(vd a, vd b) { for (int l = 0; l < LANES; l++) a[l] = name(a[l], b[l]); return a; }
LANEWISE(sin) LANEWISE(cos) LANEWISE(tan) LANEWISE(asin) LANEWISE(acos) LANEWISE(atan) LANEWISE(sinh) LANEWISE(cosh)
LANEWISE(tanh) LANEWISE(asinh) LANEWISE(acosh) LANEWISE(atanh) LANEWISE(erf) LANEWISE(floor) LANEWISE(ceil)
LANEWISE2(fmod) LANEWISE2(copysign) LANEWISE2(atan2) LANEWISE2(hypot)

/* x = k ln 2 + r with |r| <= ln 2 / 2; Taylor series of exp(r), error below 1e-17. */
static vd v_exp(vd x) {
    const vd magic = all(6755399441055744.0);
    const vd held = v_min(v_max(x, all(-745.0)), all(710.0));
    const vd shifted = held * 1.4426950408889634074 + magic;
    const vd k = shifted - magic;
    const vd r = (held - k * 6.93147180369123816490e-01) - k * 1.90821492927058770002e-10;
    vd p = all(1.0 / 6227020800.0);
    p = p * r + 1.0 / 479001600.0;
    p = p * r + 1.0 / 39916800.0;
    p = p * r + 1.0 / 3628800.0;
    p = p * r + 1.0 / 362880.0;
    p = p * r + 1.0 / 40320.0;
    p = p * r + 1.0 / 5040.0;
    p = p * r + 1.0 / 720.0;
    p = p * r + 1.0 / 120.0;
    p = p * r + 1.0 / 24.0;
    p = p * r + 1.0 / 6.0;
    p = p * r + 0.5;
    p = p * r * r + r + 1.0;
    /* In two factors, so that neither leaves the range of exponents too early. */
    const vi e = (vi)shifted - (vi)magic, half = e >> 1;
    const vd first = (vd)((half + 1023) << 52), second = (vd)((e - half + 1023) << 52);
    return choose(x != x, x, p * first * second);
}

/* x = 2**k (1 + f); the rational form of log(1 + f) in s = f/(2 + f) after fdlibm (Sun Microsystems, 1993). */
static vd v_log(vd x) {
    const vi tiny = x < 2.2250738585072014e-308;
    const vd scaled = choose(tiny, x * 18014398509481984.0, x);
    const vi bits = (vi)scaled;
    const vi rest = (bits & all_i(0x000fffffffffffffLL)) | all_i(0x3ff0000000000000LL);
    const vi upper = (vd)rest > 1.41421356237309504880;
    vi k = ((bits >> 52) & all_i(0x7ff)) - 1023 + (upper & all_i(1)) - (tiny & all_i(54));
    const vd f = choose(upper, 0.5 * (vd)rest, (vd)rest) - 1.0;
    const vd magic = all(6755399441055744.0);
    const vd e = (vd)(k + (vi)magic) - magic;
    const vd s = f / (2.0 + f), z = s * s, w = z * z;
    const vd even = w * (3.999999999940941908e-01 + w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
    const vd odd = z * (6.666666666666735130e-01 + w * (2.857142874366239149e-01
        + w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01)));
    const vd half = 0.5 * f * f;
    const vd result = e * 6.93147180369123816490e-01
        - ((half - (s * (half + even + odd) + e * 1.90821492927058770002e-10)) - f);
    const vi usual = (x > 0.0) & (x < INFINITY);
    const vd unusual = choose(x == 0.0, all(-INFINITY), choose(x > 0.0, x, all(NAN)));
    return choose(usual, result, choose(x != x, x, unusual));
}

/* W. Kahan: the rounding of 1 + x is undone by the ratio. */
static vd v_log1p(vd x) {
    const vd u = 1.0 + x;
    return choose((u == 1.0) | (x == INFINITY), x, v_log(u) * (x / (u - 1.0)));
}

static vd v_expm1(vd x) {
    const vd u = v_exp(x);
    const vd usual = (u - 1.0) * (x / v_log(u));
    return choose(u == 1.0, x, choose((u - 1.0 == -1.0) | (u == INFINITY), u - 1.0, usual));
}

static vd v_pow(vd a, vd b) {
    vd r = v_exp(b * v_log(a));
    const vi plain = (a > 0.0) & (a < INFINITY) & is_finite(b);
    if (any(~plain))
        for (int l = 0; l < LANES; l++)
            if (!plain[l]) r[l] = pow(a[l], b[l]);
    return r;
}
