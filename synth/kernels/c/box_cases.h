/* Made by `make kernels`; edits are lost. */
L_16: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = a[w]; } NEXT; }
L_17: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]]; EACH_REGISTER { target[w] = a[w] * b[w] - c[w]; } NEXT; }
L_18: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]], *const d = f[code[5]]; EACH_REGISTER { target[w] = a[w] + b[w] - c[w] * d[w]; } NEXT; }
L_19: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]], *const d = f[code[5]]; EACH_REGISTER { target[w] = a[w] + b[w] + c[w] * d[w]; } NEXT; }
L_20: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]], *const d = f[code[5]]; EACH_REGISTER { target[w] = a[w] - b[w] - c[w] * d[w]; } NEXT; }
L_21: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]], *const d = f[code[5]]; EACH_REGISTER { target[w] = a[w] - b[w] + c[w] * d[w]; } NEXT; }
L_22: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]]; EACH_REGISTER { target[w] = a[w] * (b[w] + c[w]); } NEXT; }
L_23: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = v_min(a[w], b[w]); } NEXT; }
L_24: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = v_max(a[w], b[w]); } NEXT; }
L_25: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = a[w] + b[w]; } NEXT; }
L_26: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = a[w] - b[w]; } NEXT; }
L_27: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = a[w] * b[w]; } NEXT; }
L_28: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = a[w] / b[w]; } NEXT; }
L_29: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = v_pow(a[w], b[w]); } NEXT; }
L_30: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = v_fmod(a[w], b[w]); } NEXT; }
L_31: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = v_copysign(a[w], b[w]); } NEXT; }
L_32: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = v_atan2(a[w], b[w]); } NEXT; }
L_33: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = v_hypot(a[w], b[w]); } NEXT; }
L_34: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = -a[w]; } NEXT; }
L_35: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = v_exp(a[w]); } NEXT; }
L_36: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = v_log(a[w]); } NEXT; }
L_37: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = v_sqrt(a[w]); } NEXT; }
L_38: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = v_sin(a[w]); } NEXT; }
L_39: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = v_cos(a[w]); } NEXT; }
L_40: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = v_tan(a[w]); } NEXT; }
L_41: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = v_asin(a[w]); } NEXT; }
L_42: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = v_acos(a[w]); } NEXT; }
L_43: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = v_atan(a[w]); } NEXT; }
L_44: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = v_floor(a[w]); } NEXT; }
L_45: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = v_ceil(a[w]); } NEXT; }
L_46: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = v_abs(a[w]); } NEXT; }
L_47: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = v_sign(a[w]); } NEXT; }
L_48: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = v_erf(a[w]); } NEXT; }
L_49: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = v_sinh(a[w]); } NEXT; }
L_50: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = v_cosh(a[w]); } NEXT; }
L_51: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = v_tanh(a[w]); } NEXT; }
L_52: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = v_asinh(a[w]); } NEXT; }
L_53: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = v_acosh(a[w]); } NEXT; }
L_54: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = v_atanh(a[w]); } NEXT; }
L_55: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = v_log1p(a[w]); } NEXT; }
L_56: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = v_expm1(a[w]); } NEXT; }
L_57: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = (vd)(a[w] > b[w]); } NEXT; }
L_58: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = (vd)(a[w] < b[w]); } NEXT; }
L_59: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = (vd)(a[w] >= b[w]); } NEXT; }
L_60: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]]; EACH_REGISTER { target[w] = (vd)(a[w] > b[w] * c[w]); } NEXT; }
L_61: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]]; EACH_REGISTER { target[w] = (vd)(a[w] < b[w] * c[w]); } NEXT; }
L_62: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]], *const d = f[code[5]]; EACH_REGISTER { target[w] = (vd)(a[w] > b[w] + c[w] * d[w]); } NEXT; }
L_63: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = (vd)(a[w] <= b[w]); } NEXT; }
L_64: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = (vd)(a[w] == b[w]); } NEXT; }
L_65: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = (vd)(a[w] != b[w]); } NEXT; }
L_66: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = v_fmax(a[w], b[w]); } NEXT; }
L_67: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]]; EACH_REGISTER { target[w] = v_fmax(a[w], b[w] * c[w]); } NEXT; }
L_68: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]]; EACH_REGISTER { target[w] = v_fmax(a[w], b[w] / c[w]); } NEXT; }
L_69: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]]; EACH_REGISTER { target[w] = v_fmax(a[w], b[w] + c[w]); } NEXT; }
L_70: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]]; EACH_REGISTER { target[w] = v_fmax(a[w], b[w] - c[w]); } NEXT; }
L_71: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]], *const d = f[code[5]]; EACH_REGISTER { target[w] = v_fmax(a[w], b[w] * c[w] - d[w]); } NEXT; }
L_72: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]], *const d = f[code[5]]; EACH_REGISTER { target[w] = v_fmax(a[w], b[w] - c[w] * d[w]); } NEXT; }
L_73: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = v_fmax(a[w], v_sqrt(b[w])); } NEXT; }
L_74: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = v_fmin(a[w], b[w]); } NEXT; }
L_75: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]]; EACH_REGISTER { target[w] = v_fmin(a[w], b[w] * c[w]); } NEXT; }
L_76: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]]; EACH_REGISTER { target[w] = v_fmin(a[w], b[w] / c[w]); } NEXT; }
L_77: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]]; EACH_REGISTER { target[w] = v_fmin(a[w], b[w] + c[w]); } NEXT; }
L_78: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]]; EACH_REGISTER { target[w] = v_fmin(a[w], b[w] - c[w]); } NEXT; }
L_79: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]], *const d = f[code[5]]; EACH_REGISTER { target[w] = v_fmin(a[w], b[w] * c[w] - d[w]); } NEXT; }
L_80: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]], *const d = f[code[5]]; EACH_REGISTER { target[w] = v_fmin(a[w], b[w] - c[w] * d[w]); } NEXT; }
L_81: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = v_fmin(a[w], v_sqrt(b[w])); } NEXT; }
L_82: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = (vd)~(vi)a[w]; } NEXT; }
L_83: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = (vd)((vi)a[w] & (vi)b[w]); } NEXT; }
L_84: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = (vd)((vi)a[w] | (vi)b[w]); } NEXT; }
L_85: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]]; EACH_REGISTER { target[w] = choose((vi)a[w], b[w], c[w]); } NEXT; }
L_86: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { target[w] = keep((vi)a[w], b[w]); } NEXT; }
L_87: { const vd *const a = f[code[2]]; EACH_REGISTER { target[w] = keep((vi)a[w], all(1.0)); } NEXT; }
L_88: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]]; EACH_REGISTER { target[w] = a[w] + c[w] * v_max(v_abs(a[w]), b[w]); } NEXT; }
L_89: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]]; EACH_REGISTER { target[w] = a[w] - c[w] * v_max(v_abs(a[w]), b[w]); } NEXT; }
L_90: { const vd *const a = f[code[2]]; EACH_REGISTER { dead[w] |= (vi)a[w]; } NEXT; }
L_91: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { dead[w] |= a[w] > b[w]; } NEXT; }
L_92: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { dead[w] |= a[w] < b[w]; } NEXT; }
L_93: { const vd *const a = f[code[2]], *const b = f[code[3]]; EACH_REGISTER { dead[w] |= a[w] >= b[w]; } NEXT; }
L_94: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]]; EACH_REGISTER { dead[w] |= a[w] > b[w] * c[w]; } NEXT; }
L_95: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]]; EACH_REGISTER { dead[w] |= a[w] < b[w] * c[w]; } NEXT; }
L_96: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]], *const d = f[code[5]]; EACH_REGISTER { dead[w] |= a[w] > b[w] + c[w] * d[w]; } NEXT; }
L_97: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]], *const d = f[code[5]]; EACH_REGISTER { const vd low = v_fmax(target[w], a[w] * b[w]), high = v_fmin(target_1[w], c[w] * d[w]); target[w] = low; target_1[w] = high; } NEXT; }
L_98: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]], *const d = f[code[5]]; EACH_REGISTER { const vd low = v_fmax(target[w], a[w] / b[w]), high = v_fmin(target_1[w], c[w] / d[w]); target[w] = low; target_1[w] = high; } NEXT; }
L_99: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]], *const d = f[code[5]]; EACH_REGISTER { const vd low = v_fmax(target[w], a[w] + b[w]), high = v_fmin(target_1[w], c[w] + d[w]); target[w] = low; target_1[w] = high; } NEXT; }
L_100: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]], *const d = f[code[5]]; EACH_REGISTER { const vd low = v_fmax(target[w], a[w] - b[w]), high = v_fmin(target_1[w], c[w] - d[w]); target[w] = low; target_1[w] = high; } NEXT; }
L_101: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]], *const d = f[code[5]]; EACH_REGISTER { const vd low = a[w] * b[w], high = c[w] * d[w]; target[w] = low; target_1[w] = high; } NEXT; }
L_102: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]], *const d = f[code[5]]; EACH_REGISTER { const vd low = a[w] / b[w], high = c[w] / d[w]; target[w] = low; target_1[w] = high; } NEXT; }
L_103: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]], *const d = f[code[5]]; EACH_REGISTER { const vd low = a[w] + b[w], high = c[w] + d[w]; target[w] = low; target_1[w] = high; } NEXT; }
L_104: { const vd *const a = f[code[2]], *const b = f[code[3]], *const c = f[code[4]], *const d = f[code[5]]; EACH_REGISTER { const vd low = a[w] - b[w], high = c[w] - d[w]; target[w] = low; target_1[w] = high; } NEXT; }
L_105: { EACH_REGISTER { const Interval i = forward_103(both(f[code[2]][w], f[code[2] + 1][w]), both(f[code[3]][w], f[code[3] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_106: { EACH_REGISTER { const Interval i = forward_104(both(f[code[2]][w], f[code[2] + 1][w]), both(f[code[3]][w], f[code[3] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_107: { EACH_REGISTER { const Interval i = forward_111(both(f[code[2]][w], f[code[2] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_108: { EACH_REGISTER { const Interval i = forward_136(both(f[code[2]][w], f[code[2] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_109: { EACH_REGISTER { const Interval i = forward_129(both(f[code[2]][w], f[code[2] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_110: { EACH_REGISTER { const Interval i = forward_113(both(f[code[2]][w], f[code[2] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_111: { EACH_REGISTER { const Interval i = forward_114(both(f[code[2]][w], f[code[2] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_112: { EACH_REGISTER { const Interval i = forward_115(both(f[code[2]][w], f[code[2] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_113: { EACH_REGISTER { const Interval i = forward_138(both(f[code[2]][w], f[code[2] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_114: { EACH_REGISTER { const Interval i = forward_195(both(f[code[2]][w], f[code[2] + 1][w]), both(f[code[3]][w], f[code[3] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_115: { EACH_REGISTER { const Interval i = forward_143(both(f[code[2]][w], f[code[2] + 1][w]), both(f[code[3]][w], f[code[3] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_116: { EACH_REGISTER { const Interval i = forward_121(both(f[code[2]][w], f[code[2] + 1][w]), both(f[code[3]][w], f[code[3] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_117: { EACH_REGISTER { const Interval i = forward_122(both(f[code[2]][w], f[code[2] + 1][w]), both(f[code[3]][w], f[code[3] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_118: { EACH_REGISTER { const Interval i = forward_power_constant(both(f[code[2]][w], f[code[2] + 1][w]), both(f[code[3]][w], f[code[3] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_119: { EACH_REGISTER { const Interval i = forward_power_any(both(f[code[2]][w], f[code[2] + 1][w]), both(f[code[3]][w], f[code[3] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_120: { EACH_REGISTER { const Interval i = backward_101_0(both(f[code[2]][w], f[code[2] + 1][w]), both(f[code[4]][w], f[code[4] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_121: { EACH_REGISTER { const Interval i = backward_101_1(both(f[code[2]][w], f[code[2] + 1][w]), both(f[code[3]][w], f[code[3] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_122: { EACH_REGISTER { const Interval i = backward_102_0(both(f[code[2]][w], f[code[2] + 1][w]), both(f[code[4]][w], f[code[4] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_123: { EACH_REGISTER { const Interval i = backward_102_1(both(f[code[2]][w], f[code[2] + 1][w]), both(f[code[3]][w], f[code[3] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_124: { EACH_REGISTER { const Interval i = backward_103_0(both(f[code[2]][w], f[code[2] + 1][w]), both(f[code[4]][w], f[code[4] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_125: { EACH_REGISTER { const Interval i = backward_103_1(both(f[code[2]][w], f[code[2] + 1][w]), both(f[code[3]][w], f[code[3] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_126: { EACH_REGISTER { const Interval i = backward_104_0(both(f[code[2]][w], f[code[2] + 1][w]), both(f[code[4]][w], f[code[4] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_127: { EACH_REGISTER { const Interval i = backward_104_1(both(f[code[2]][w], f[code[2] + 1][w]), both(f[code[3]][w], f[code[3] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_128: { EACH_REGISTER { const Interval i = backward_136_0(both(f[code[2]][w], f[code[2] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_129: { EACH_REGISTER { const Interval i = backward_106_0(both(f[code[2]][w], f[code[2] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_130: { EACH_REGISTER { const Interval i = backward_194_0(both(f[code[2]][w], f[code[2] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
L_131: { EACH_REGISTER { const Interval i = backward_power(both(f[code[2]][w], f[code[2] + 1][w]), both(f[code[3]][w], f[code[3] + 1][w]), both(f[code[4]][w], f[code[4] + 1][w])); target[w] = i.low; target_1[w] = i.high; } NEXT; }
