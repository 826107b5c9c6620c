// 3 x 3 matrices over a number type, as far as the tangents of the kernels need them.
#pragma once
#include "core/ad.hpp"

namespace dp {

template <class T>
struct Matrix {
    Vec<T> x, y, z;  // rows
    Matrix& operator+=(const Matrix& b) { x += b.x; y += b.y; z += b.z; return *this; }
    Matrix& operator-=(const Matrix& b) { x -= b.x; y -= b.y; z -= b.z; return *this; }
};
template <class T> inline Matrix<T> operator+(const Matrix<T>& a, const Matrix<T>& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
template <class T> inline Matrix<T> operator-(const Matrix<T>& a, const Matrix<T>& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
template <class T> inline Matrix<T> operator-(const Matrix<T>& a) { return {-a.x, -a.y, -a.z}; }
template <class T, class S> inline Matrix<T> operator*(const Matrix<T>& a, const S& s) { return {a.x * s, a.y * s, a.z * s}; }
template <class T> inline Matrix<T> outer(const Vec<T>& a, const Vec<T>& b) { return {b * a.x, b * a.y, b * a.z}; }
template <class T> inline Matrix<T> skew(const Vec<T>& a) {  // skew(a) b = a x b
    const T zero = T(0.0);
    return {{zero, -a.z, a.y}, {a.z, zero, -a.x}, {-a.y, a.x, zero}};
}
template <class T> inline Matrix<T> scalar_matrix(const T& s) {
    const T zero = T(0.0);
    return {{s, zero, zero}, {zero, s, zero}, {zero, zero, s}};
}
template <class T> inline Matrix<T> transpose(const Matrix<T>& a) { return {{a.x.x, a.y.x, a.z.x}, {a.x.y, a.y.y, a.z.y}, {a.x.z, a.y.z, a.z.z}}; }
template <class T> inline Vec<T> operator*(const Vec<T>& a, const Matrix<T>& m) { return m.x * a.x + m.y * a.y + m.z * a.z; }  // a^T m

// K += m at row i and column j of a table of rows with N entries
template <int N, class T> inline void add(T (*K)[N], int i, int j, const Matrix<T>& m) {
    K[i][j] += m.x.x; K[i][j + 1] += m.x.y; K[i][j + 2] += m.x.z;
    K[i + 1][j] += m.y.x; K[i + 1][j + 1] += m.y.y; K[i + 1][j + 2] += m.y.z;
    K[i + 2][j] += m.z.x; K[i + 2][j + 1] += m.z.y; K[i + 2][j + 2] += m.z.z;
}

}  // namespace dp
