// Quaternions over a number type: (w, x, y, z) with the scalar part first; directions are those of q whatever its length.
#pragma once
#include "core/ad.hpp"

namespace dp {

template <class T>
struct Quat {
    T w, x, y, z;
    Quat& operator+=(const Quat& b) { w += b.w; x += b.x; y += b.y; z += b.z; return *this; }
};
template <class T> inline Quat<T> quat(const T* p) { return {p[0], p[1], p[2], p[3]}; }
template <class T> inline Quat<T> operator+(const Quat<T>& a, const Quat<T>& b) { return {a.w + b.w, a.x + b.x, a.y + b.y, a.z + b.z}; }
template <class T> inline Quat<T> operator-(const Quat<T>& a, const Quat<T>& b) { return {a.w - b.w, a.x - b.x, a.y - b.y, a.z - b.z}; }
template <class T, class S> inline Quat<T> operator*(const Quat<T>& a, const S& s) { return {a.w * s, a.x * s, a.y * s, a.z * s}; }
template <class T> inline T dot(const Quat<T>& a, const Quat<T>& b) { return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z; }

// products with the unit vectors of the section: q e1, q e2, q e3
template <class T> inline Quat<T> times_e1(const Quat<T>& q) { return {-q.x, q.w, q.z, -q.y}; }
template <class T> inline Quat<T> times_e2(const Quat<T>& q) { return {-q.y, -q.z, q.w, q.x}; }
template <class T> inline Quat<T> times_e3(const Quat<T>& q) { return {-q.z, q.y, -q.x, q.w}; }
// f q of a vector f: what a moment f/2 gives to the components of q, as dpsi = 2 vec(dq q*) for |q| = 1
template <class T, class U> inline auto times(const Vec<U>& f, const Quat<T>& q) -> Quat<decltype(f.x * q.w)> {
    return {-(f.x * q.x + f.y * q.y + f.z * q.z), f.x * q.w + f.y * q.z - f.z * q.y, f.y * q.w + f.z * q.x - f.x * q.z,
            f.z * q.w + f.x * q.y - f.y * q.x};
}
// vector part of a b*
template <class T> inline Vec<T> vector_of(const Quat<T>& a, const Quat<T>& b) {
    return {a.x * b.w - a.w * b.x - a.y * b.z + a.z * b.y, a.y * b.w - a.w * b.y - a.z * b.x + a.x * b.z,
            a.z * b.w - a.w * b.z - a.x * b.y + a.y * b.x};
}

}  // namespace dp
