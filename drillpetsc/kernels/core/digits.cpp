// Numbers as text, each by the shortest digits that read back as the same double.
#include <charconv>
#include <cmath>
#include <cstring>

#include "core/names.hpp"

// Most characters of a number, with its comma: sign, 17 digits, point and exponent; or up to 16 digits before the point.
DP_CONSTANT(text_width, 32)

// Writes n rows of m numbers, commas between them and a line end behind each row, to `out`, which holds n m numbers of that width.  As Python's
// repr, but for a ".0" at the end: with an exponent below 1e-4 and from 1e16 on.  Returns the length, or -1 where the library of the compiler has no
// such digits.
extern "C" int write_rows(int n, int m, const double* values, char* out) {
#ifdef __cpp_lib_to_chars
    char* to = out;
    for (int row = 0; row < n; ++row) {
        for (int k = 0; k < m; ++k) {
            const double v = *values++, size = std::fabs(v);
            if (k) *to++ = ',';
            if (!std::isfinite(v)) {
                const char* word = std::isnan(v) ? "nan" : v < 0 ? "-inf" : "inf";
                to = static_cast<char*>(std::memcpy(to, word, std::strlen(word))) + std::strlen(word);
                continue;
            }
            const bool fixed = v == 0.0 || (size >= 1e-4 && size < 1e16);
            to = std::to_chars(to, to + 31, v, fixed ? std::chars_format::fixed : std::chars_format::scientific).ptr;
        }
        *to++ = '\n';
    }
    return static_cast<int>(to - out);
#else
    return -1;
#endif
}
