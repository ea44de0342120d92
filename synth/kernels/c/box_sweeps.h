/* Carries out one list for a block of so many registers; 0 where no box is alive any more. Each instruction jumps to the
   next one itself, which processors predict better than a jump that all share. Included twice: for blocks that are whole,
   whose loops have a fixed length, and for others. */
static int CARRIED_OUT(const int *code, vd (*f)[WIDE], const Whole *whole, vi *dead, int wide) {
    static const void *const LABEL[] = {LABELS};
    vd *target, *target_1;
    GO;
L_END: return 1;
L_END_IF_DEAD: {
    vi living = all_i(0);
    EACH_REGISTER living |= ~dead[w];
    if (!any(living)) return 0;
    NEXT;
}
L_HOLD: {
    const vd low = whole->RL[code[2]], high = whole->RH[code[2]];
    EACH_REGISTER { target[w] = v_fmax(target[w], low); target_1[w] = v_fmin(target_1[w], high); }
    NEXT;
}
L_IN_ORDER: {
    const int count = code[2];
    for (int k = 0; k < count; k++, target += 2 * WIDE, target_1 += 2 * WIDE)
        EACH_REGISTER {
            const vd low = target[w], high = target_1[w];
            const vi crossed = low > high;
            target[w] = choose(crossed, high, low);
            target_1[w] = choose(crossed, low, high);
        }
    NEXT;
}
L_CROSSED: {
    const int count = code[2];
    ONE(c, 3);
    for (int k = 0; k < count; k++, target += 2 * WIDE, target_1 += 2 * WIDE)
        EACH_REGISTER dead[w] |= target[w] > target_1[w] + c[w] * target_1[w];
    NEXT;
}
L_MEET: {
    ENDS(s, 2);
    EACH_REGISTER { target[w] = v_fmax(target[w], s[w]); target_1[w] = v_fmin(target_1[w], s_1[w]); }
    NEXT;
}
L_PRODUCT_BACK: {
    ENDS(k, 2); OTHER(3);
    BACK(k[w] / target_1[w], k_1[w] / target[w], k[w] / y_1[w], k_1[w] / y[w]);
}
L_QUOTIENT_BACK: {
    ENDS(k, 2); OTHER(3);
    BACK(target[w] / k_1[w], target_1[w] / k[w], k[w] * y[w], k_1[w] * y_1[w]);
}
L_SUM_BACK: {
    ENDS(k, 2); OTHER(3); ONE(l, 4); ONE(m, 5);
    BACK(k[w] * l[w] - target_1[w], k_1[w] * m[w] - target[w], k[w] * l[w] - y_1[w], k_1[w] * m[w] - y[w]);
}
L_DIFFERENCE_BACK: {
    ENDS(k, 2); OTHER(3); ONE(l, 4); ONE(m, 5);
    BACK(target[w] * l[w] - k_1[w], target_1[w] * m[w] - k[w], k[w] + y[w], k_1[w] + y_1[w]);
}
L_TERM_BACK: {
    ENDS(k, 2); ENDS(y, 3); ONE(l, 4); ONE(m, 5);
    EACH_REGISTER {
        target[w] = v_fmax(target[w], k[w] * l[w] - y_1[w]);
        target_1[w] = v_fmin(target_1[w], k_1[w] * m[w] - y[w]);
    }
    NEXT;
}
L_ROOT: {
    ENDS(a, 2);
    EACH_REGISTER { target[w] = v_fmax(target[w], v_sqrt(a[w])); target_1[w] = v_fmin(target_1[w], v_sqrt(a_1[w])); }
    NEXT;
}
L_SUM: {
    ENDS(a, 2); ENDS(b, 3); ONE(c, 4);
    EACH_REGISTER {
        target[w] = v_fmax(target[w], a[w] + b[w] - c[w] * a[w]);
        target_1[w] = v_fmin(target_1[w], a_1[w] + b_1[w] + c[w] * a_1[w]);
    }
    NEXT;
}
L_DIFFERENCE: {
    ENDS(a, 2); ENDS(b, 3); ONE(c, 4);
    EACH_REGISTER {
        target[w] = v_fmax(target[w], a[w] - b_1[w] - c[w] * a[w]);
        target_1[w] = v_fmin(target_1[w], a_1[w] - b[w] + c[w] * a_1[w]);
    }
    NEXT;
}
L_AT_MOST: {
    ONE(b, 2); ONE(c, 3); ONE(d, 5);
    vd *const open = f[code[4]];
    EACH_REGISTER {
        const vd s = b[w] * c[w];
        dead[w] |= target[w] > s;
        target_1[w] = v_fmin(target_1[w], s);
        open[w] = (vd)(target_1[w] > d[w]);
    }
    NEXT;
}
L_AT_LEAST: {
    ONE(b, 2); ONE(c, 3); ONE(d, 5);
    vd *const open = f[code[4]];
    EACH_REGISTER {
        const vd s = b[w] * c[w];
        dead[w] |= target_1[w] < s;
        target[w] = v_fmax(target[w], s);
        open[w] = (vd)(target[w] < d[w]);
    }
    NEXT;
}
#include "box_cases.h"
}
