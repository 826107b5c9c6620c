// Denormal numbers as zero, in this thread: numbers below 2e-308, on which processors take a hundred times as long.
#if defined(__SSE2__)
#include <xmmintrin.h>
namespace {
constexpr unsigned long FLUSH = 0x8040;  // results (FTZ) and operands (DAZ)
unsigned long control() { return _mm_getcsr(); }
void set_control(unsigned long word) { _mm_setcsr(static_cast<unsigned>(word)); }
}  // namespace
#elif defined(__aarch64__)
namespace {
constexpr unsigned long FLUSH = 1ul << 24;  // FZ
unsigned long control() { unsigned long word; __asm__ volatile("mrs %0, fpcr" : "=r"(word)); return word; }
void set_control(unsigned long word) { __asm__ volatile("msr fpcr, %0" : : "r"(word)); }
}  // namespace
#else
namespace {
constexpr unsigned long FLUSH = 0;
unsigned long control() { return 0; }
void set_control(unsigned long) {}
}  // namespace
#endif

// Take them as zero from now on (flush not 0), or as numbers; returns whether they were taken as zero before.
extern "C" int flush_denormals(int flush) {
    const unsigned long before = control();
    set_control(flush ? before | FLUSH : before & ~FLUSH);
    return FLUSH && (before & FLUSH) == FLUSH;
}
