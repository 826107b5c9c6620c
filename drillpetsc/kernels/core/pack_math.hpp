// exp and log of four numbers side by side, without branches: the rational approximations of the Cephes library (S. L. Moshier, exp.c and
// log.c, relative error 2e-16).  A number that is not finite gives NaN.
#pragma once
#include <cstring>

#include "core/ad.hpp"

namespace dp {

inline I4 bits(const V4& a) { I4 r; std::memcpy(&r, &a, sizeof r); return r; }
inline V4 number(const I4& a) { V4 r; std::memcpy(&r, &a, sizeof r); return r; }

// e^x = 2^n e^r with n the integer next to x/ln 2; arguments are held within the range of normal numbers
inline Pack exp(const Pack& a) {
    V4 x = a.v > 708.0 ? splat(708.0) : a.v;
    x = x < -708.0 ? splat(-708.0) : x;
    constexpr double SHIFT = 6755399441055744.0;  // 1.5 * 2^52: the sum's last bits are the integer
    const V4 shifted = x * 1.4426950408889634 + SHIFT, n = shifted - SHIFT;
    const V4 r = (x - n * 6.93145751953125e-1) - n * 1.42860682030941723212e-6, z = r * r;
    const V4 P = r * ((1.26177193074810590878e-4 * z + 3.02994407707441961300e-2) * z + 9.99999999999999999910e-1);
    const V4 Q = ((3.00198505138664455042e-6 * z + 2.52448340349684104192e-3) * z + 2.27265548208155028766e-1) * z + 2.0;
    return Pack((1.0 + 2.0 * (P / (Q - P))) * number((bits(shifted) << 52) + (1023LL << 52)));
}

// log of a positive normal number 2^e (1 + r), 1 + r between sqrt(1/2) and sqrt(2)
inline Pack log(const Pack& a) {
    const I4 raw = bits(a.v), fraction = (raw & 0xFFFFFFFFFFFFFLL) | (1022LL << 52);
    V4 m = number(fraction), e = number(((raw >> 52) & 0x7FF) | bits(splat(4503599627370496.0))) - (4503599627370496.0 + 1022.0);
    const I4 low = m < 0.70710678118654752440;
    e = low ? e - 1.0 : e;
    const V4 r = (low ? m + m : m) - 1.0, z = r * r;
    const V4 P = ((((1.01875663804580931796e-4 * r + 4.97494994976747001425e-1) * r + 4.70579119878881725854) * r + 1.44989225341610930846e1) * r +
                  1.79368678507819816313e1) * r + 7.70838733755885391666;
    const V4 Q = ((((r + 1.12873587189167450590e1) * r + 4.52279145837532221105e1) * r + 8.29875266912776603211e1) * r +
                  7.11544750618563894466e1) * r + 2.31251620126765340583e1;
    const V4 y = r * (z * P / Q) - e * 2.121944400546905827679e-4 - 0.5 * z;
    return Pack((r + y) + e * 0.693359375 + (a.v - a.v));
}

}  // namespace dp
