/* What is done for each operation: its name is that in synth/bounds/instructions.py. */

#define UNUSED __attribute__((unused))
#define OPERANDS UNUSED const vd *const p = f[code[2]], UNUSED *const q = f[code[3]], UNUSED *const r = f[code[4]], UNUSED *const s = f[code[5]]
#define LETTERS UNUSED const vd a = p[w], UNUSED b = q[w], UNUSED c = r[w], UNUSED d = s[w]
#define VALUE(name, expression) L_##name: { OPERANDS; EACH_REGISTER { LETTERS; target[w] = expression; } NEXT; }
#define MASK(name, condition) VALUE(name, (vd)(condition))
#define KILL(name, condition) L_##name: { OPERANDS; EACH_REGISTER { LETTERS; dead[w] |= condition; } NEXT; }
#define BOTH(name, sign) \
    L_ENDS_##name: { \
        OPERANDS; \
        EACH_REGISTER { \
            LETTERS; \
            const vd low = a sign b, high = c sign d; \
            target[w] = low; \
            target_1[w] = high; \
        } \
        NEXT; \
    } \
    L_MET_##name: { \
        OPERANDS; \
        EACH_REGISTER { \
            LETTERS; \
            const vd low = v_fmax(target[w], a sign b), high = v_fmin(target_1[w], c sign d); \
            target[w] = low; \
            target_1[w] = high; \
        } \
        NEXT; \
    }
#define INTERVAL(k) both(f[code[k]][w], f[code[k] + 1][w])
#define RULED(label, arguments, enclosure) \
    label: { \
        EACH_REGISTER { \
            arguments; \
            const Interval found = enclosure; \
            target[w] = found.low; \
            target_1[w] = found.high; \
        } \
        NEXT; \
    }
#define FORWARD(name, enclosure) \
    RULED(L_FORWARD_##name, UNUSED const Interval a = INTERVAL(2); UNUSED const Interval b = INTERVAL(3); UNUSED const Interval c = INTERVAL(4), enclosure)
#define BACKWARD(name, enclosure) \
    RULED(L_BACKWARD_##name, const Interval r = INTERVAL(2); UNUSED const Interval a = INTERVAL(3); UNUSED const Interval b = INTERVAL(4), enclosure)
#define RISING(name, function) FORWARD(name, both(function(a.low), function(a.high)))
#define ON_DOMAIN(name, function, from, to) \
    FORWARD(name, both(function(clipped(a.low, from, to)), function(clipped(a.high, from, to))))

VALUE(MOVE, a)
VALUE(ADD, a + b)
VALUE(SUB, a - b)
VALUE(MUL, a * b)
VALUE(DIV, a / b)
VALUE(POW, v_pow(a, b))
VALUE(FMOD, v_fmod(a, b))
VALUE(COPYSIGN, v_copysign(a, b))
VALUE(ATAN2, v_atan2(a, b))
VALUE(HYPOT, v_hypot(a, b))
VALUE(MIN, v_min(a, b))
VALUE(MAX, v_max(a, b))
VALUE(NEG, -a)
VALUE(EXP, v_exp(a))
VALUE(LOG, v_log(a))
VALUE(SQRT, v_sqrt(a))
VALUE(SIN, v_sin(a))
VALUE(COS, v_cos(a))
VALUE(TAN, v_tan(a))
VALUE(ASIN, v_asin(a))
VALUE(ACOS, v_acos(a))
VALUE(ATAN, v_atan(a))
VALUE(FLOOR, v_floor(a))
VALUE(CEIL, v_ceil(a))
VALUE(ABS, v_abs(a))
VALUE(SIGN, v_sign(a))
VALUE(ERF, v_erf(a))
VALUE(SINH, v_sinh(a))
VALUE(COSH, v_cosh(a))
VALUE(TANH, v_tanh(a))
VALUE(ASINH, v_asinh(a))
VALUE(ACOSH, v_acosh(a))
VALUE(ATANH, v_atanh(a))
VALUE(LOG1P, v_log1p(a))
VALUE(EXPM1, v_expm1(a))
VALUE(MUL_SUB, a * b - c)
VALUE(MUL_SUM, a * (b + c))
VALUE(ADD_SUB_MUL, a + b - c * d)
VALUE(ADD_ADD_MUL, a + b + c * d)
VALUE(SUB_SUB_MUL, a - b - c * d)
VALUE(SUB_ADD_MUL, a - b + c * d)
VALUE(LOOSEN_UP, a + c * v_max(v_abs(a), b))
VALUE(LOOSEN_DOWN, a - c * v_max(v_abs(a), b))
VALUE(FMAX, v_fmax(a, b))
VALUE(FMAX_MUL, v_fmax(a, b * c))
VALUE(FMAX_DIV, v_fmax(a, b / c))
VALUE(FMAX_MUL_SUB, v_fmax(a, b * c - d))
VALUE(FMAX_SQRT, v_fmax(a, v_sqrt(b)))
VALUE(FMIN, v_fmin(a, b))
VALUE(FMIN_MUL, v_fmin(a, b * c))
VALUE(FMIN_DIV, v_fmin(a, b / c))
VALUE(FMIN_MUL_SUB, v_fmin(a, b * c - d))
VALUE(FMIN_SQRT, v_fmin(a, v_sqrt(b)))
MASK(GT, a > b)
MASK(LT, a < b)
MASK(GE, a >= b)
MASK(LE, a <= b)
MASK(EQ, a == b)
MASK(NE, a != b)
MASK(GT_MUL, a > b * c)
MASK(LT_MUL, a < b * c)
MASK(NOT, ~(vi)a)
MASK(AND, (vi)a & (vi)b)
MASK(OR, (vi)a | (vi)b)
VALUE(CHOOSE, choose((vi)a, b, c))
VALUE(KEEP, keep((vi)a, b))
VALUE(TRUTH, TRUTH((vi)a))
KILL(KILL_ABOVE, a > b)
KILL(KILL_BELOW, a < b)
KILL(KILL_CROSSED, a > b + c * d)
BOTH(ADD, +)
BOTH(SUB, -)
BOTH(MUL, *)
BOTH(DIV, /)

FORWARD(ADD, both(a.low + b.low, a.high + b.high))
FORWARD(SUB, both(a.low - b.high, a.high - b.low))
FORWARD(MUL, forward_mul(a, b))
FORWARD(DIV, forward_div(a, b))
FORWARD(NEG, both(-a.high, -a.low))
FORWARD(SQ, i_sq(a))
FORWARD(TWICE, both(2.0 * a.low, 2.0 * a.high))
RISING(EXP, v_exp)
ON_DOMAIN(LOG, v_log, 0.0, INFINITY)
ON_DOMAIN(LOG1P, v_log1p, -1.0, INFINITY)
RISING(EXPM1, v_expm1)
ON_DOMAIN(SQRT, v_sqrt, 0.0, INFINITY)
FORWARD(INV, forward_inv(a))
FORWARD(FABS, i_abs(a))
FORWARD(SIN, forward_sin(a))
FORWARD(COS, forward_cos(a))
FORWARD(TAN, forward_tan(a))
ON_DOMAIN(ASIN, v_asin, -1.0, 1.0)
FORWARD(ACOS, both(v_acos(clipped(a.high, -1.0, 1.0)), v_acos(clipped(a.low, -1.0, 1.0))))
RISING(ATAN, v_atan)
RISING(SINH, v_sinh)
FORWARD(COSH, forward_cosh(a))
RISING(TANH, v_tanh)
RISING(ASINH, v_asinh)
ON_DOMAIN(ACOSH, v_acosh, 1.0, INFINITY)
ON_DOMAIN(ATANH, v_atanh, -1.0, 1.0)
RISING(FLOOR, v_floor)
RISING(CEIL, v_ceil)
RISING(SIGN, v_sign)
FORWARD(FMIN, both(v_min(a.low, b.low), v_min(a.high, b.high)))
FORWARD(FMAX, both(v_max(a.low, b.low), v_max(a.high, b.high)))
FORWARD(HYPOT, forward_hypot(a, b))
FORWARD(ATAN2, forward_atan2(a, b))
FORWARD(LT, both(TRUTH(a.high < b.low), 1.0 - TRUTH(a.low >= b.high)))
FORWARD(LE, both(TRUTH(a.high <= b.low), 1.0 - TRUTH(a.low > b.high)))
FORWARD(EQ, forward_eq(a, b))
FORWARD(NE, forward_ne(a, b))
FORWARD(NOT, both(1.0 - a.high, 1.0 - a.low))
FORWARD(AND, both(a.low * b.low, a.high * b.high))
FORWARD(OR, both(v_max(a.low, b.low), v_max(a.high, b.high)))
FORWARD(IF_ELSE_ZERO, both(choose(a.low > 0.5, b.low, keep(a.high > 0.5, v_min(b.low, all(0.0)))),
                           choose(a.low > 0.5, b.high, keep(a.high > 0.5, v_max(b.high, all(0.0))))))
FORWARD(SELECT, both(choose(a.low > 0.5, b.low, choose(a.high < 0.5, c.low, v_min(b.low, c.low))),
                     choose(a.low > 0.5, b.high, choose(a.high < 0.5, c.high, v_max(b.high, c.high)))))
FORWARD(POW_CONSTANT, forward_pow_constant(a, b))
FORWARD(POW_ANY, forward_pow_any(a, b))
RULED(L_WHOLE_1, const vd sum = f[code[2]][w], whole_of(sum))
RULED(L_WHOLE_2, const vd sum = f[code[2]][w] + f[code[3]][w], whole_of(sum))
RULED(L_WHOLE_3, const vd sum = f[code[2]][w] + f[code[3]][w] + f[code[4]][w], whole_of(sum))

BACKWARD(ADD_0, sum_less(r, b))
BACKWARD(ADD_1, sum_less(r, a))
BACKWARD(SUB_0, difference_more(r, b))
BACKWARD(SUB_1, difference_less(r, a))
BACKWARD(MUL_0, quotient(r, b))
BACKWARD(MUL_1, quotient(r, a))
BACKWARD(DIV_0, forward_mul(r, b))
BACKWARD(DIV_1, quotient(a, r))
BACKWARD(NEG_0, both(-r.high, -r.low))
BACKWARD(TWICE_0, both(0.5 * r.low, 0.5 * r.high))
BACKWARD(SQ_0, both(choose(a.low >= 0.0, v_sqrt(v_max(r.low, all(0.0))), -v_sqrt(v_max(r.high, all(0.0)))),
                    choose(a.high <= 0.0, -v_sqrt(v_max(r.low, all(0.0))), v_sqrt(v_max(r.high, all(0.0))))))
BACKWARD(INV_0, quotient(both(all(1.0), all(1.0)), r))
BACKWARD(EXP_0, backward_exp(r))
BACKWARD(LOG_0, both(v_exp(r.low), v_exp(r.high)))
BACKWARD(LOG1P_0, both(v_expm1(r.low), v_expm1(r.high)))
BACKWARD(EXPM1_0, backward_expm1(r))
BACKWARD(SQRT_0, both(keep(r.low > 0.0, r.low * r.low), r.high * r.high))
BACKWARD(FABS_0, both(choose(a.low >= 0.0, r.low, -r.high), choose(a.high <= 0.0, -r.low, r.high)))
BACKWARD(FMAX_0, both(all(-INFINITY), r.high))
BACKWARD(FMAX_1, both(all(-INFINITY), r.high))
BACKWARD(FMIN_0, both(r.low, all(INFINITY)))
BACKWARD(FMIN_1, both(r.low, all(INFINITY)))
BACKWARD(IF_ELSE_ZERO_1, where(a.low > 0.5, r, unknown()))
BACKWARD(SELECT_1, where(a.low > 0.5, r, unknown()))
BACKWARD(SELECT_2, where(a.high < 0.5, r, unknown()))
BACKWARD(POW_CONSTANT, backward_pow(r, a, b))
