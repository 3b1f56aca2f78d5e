/// What Eigen calls of SSE2, for WebAssembly, in the compiler's own vector types, which become its registers of 128 bits.
///
/// With __SSE2__ defined Eigen takes the way that it takes on x86-64, so sums are added in the same order and results have the same bits.
/// What Eigen names but the core never calls (numbers of single precision, arrays of bool) is only declared: a call of it does not link.
/// Eigen includes this as C, so there are no templates and no overloads. The names and what they do are Intel's.
#pragma once

typedef double __m128d __attribute__((vector_size(16)));
typedef float __m128 __attribute__((vector_size(16)));
typedef long long __m128i __attribute__((vector_size(16)));
typedef long long __m64;
typedef int sse2_ints __attribute__((vector_size(16)));

#define SSE2 static inline __attribute__((always_inline))

// ---- two doubles: the number in place 0 is the one that stands first in memory ----
SSE2 __m128d _mm_set_pd(double second, double first) { return __m128d{first, second}; }
SSE2 __m128d _mm_set1_pd(double x) { return __m128d{x, x}; }
SSE2 __m128d _mm_set_sd(double x) { return __m128d{x, 0}; }
SSE2 __m128d _mm_setzero_pd() { return __m128d{0, 0}; }
SSE2 double _mm_cvtsd_f64(__m128d a) { return a[0]; }

SSE2 __m128d _mm_loadu_pd(const double* from) {
  __m128d a;
  __builtin_memcpy(&a, from, sizeof a);
  return a;
}
SSE2 __m128d _mm_load_pd(const double* from) { return _mm_loadu_pd(from); }
SSE2 void _mm_storeu_pd(double* to, __m128d a) { __builtin_memcpy(to, &a, sizeof a); }
SSE2 void _mm_store_pd(double* to, __m128d a) { _mm_storeu_pd(to, a); }

SSE2 __m128d _mm_add_pd(__m128d a, __m128d b) { return a + b; }
SSE2 __m128d _mm_sub_pd(__m128d a, __m128d b) { return a - b; }
SSE2 __m128d _mm_mul_pd(__m128d a, __m128d b) { return a * b; }
SSE2 __m128d _mm_div_pd(__m128d a, __m128d b) { return a / b; }
SSE2 __m128d _mm_sqrt_pd(__m128d a) { return __builtin_elementwise_sqrt(a); }
SSE2 __m128d _mm_min_pd(__m128d a, __m128d b) { return a < b ? a : b; }  // b where one of them is not a number
SSE2 __m128d _mm_max_pd(__m128d a, __m128d b) { return a > b ? a : b; }
SSE2 __m128d _mm_add_sd(__m128d a, __m128d b) { return __m128d{a[0] + b[0], a[1]}; }
SSE2 __m128d _mm_mul_sd(__m128d a, __m128d b) { return __m128d{a[0] * b[0], a[1]}; }
SSE2 __m128d _mm_min_sd(__m128d a, __m128d b) { return __m128d{a[0] < b[0] ? a[0] : b[0], a[1]}; }
SSE2 __m128d _mm_max_sd(__m128d a, __m128d b) { return __m128d{a[0] > b[0] ? a[0] : b[0], a[1]}; }

SSE2 __m128d _mm_and_pd(__m128d a, __m128d b) { return (__m128d)((__m128i)a & (__m128i)b); }
SSE2 __m128d _mm_or_pd(__m128d a, __m128d b) { return (__m128d)((__m128i)a | (__m128i)b); }
SSE2 __m128d _mm_xor_pd(__m128d a, __m128d b) { return (__m128d)((__m128i)a ^ (__m128i)b); }
SSE2 __m128d _mm_andnot_pd(__m128d a, __m128d b) { return (__m128d)(~(__m128i)a & (__m128i)b); }
SSE2 __m128d _mm_cmpeq_pd(__m128d a, __m128d b) { return (__m128d)(a == b); }
SSE2 __m128d _mm_cmplt_pd(__m128d a, __m128d b) { return (__m128d)(a < b); }
SSE2 __m128d _mm_cmple_pd(__m128d a, __m128d b) { return (__m128d)(a <= b); }
SSE2 __m128d _mm_cmpgt_pd(__m128d a, __m128d b) { return (__m128d)(a > b); }
SSE2 __m128d _mm_cmpnge_pd(__m128d a, __m128d b) { return (__m128d)~(a >= b); }

SSE2 __m128d _mm_unpacklo_pd(__m128d a, __m128d b) { return __m128d{a[0], b[0]}; }
SSE2 __m128d _mm_unpackhi_pd(__m128d a, __m128d b) { return __m128d{a[1], b[1]}; }
SSE2 __m128d _mm_shuffle_pd(__m128d a, __m128d b, int places) { return __m128d{a[places & 1], b[places >> 1 & 1]}; }

// ---- the same bits as another type ----
SSE2 __m128i _mm_castpd_si128(__m128d a) { return (__m128i)a; }
SSE2 __m128d _mm_castsi128_pd(__m128i a) { return (__m128d)a; }
SSE2 __m128 _mm_castpd_ps(__m128d a) { return (__m128)a; }
SSE2 __m128d _mm_castps_pd(__m128 a) { return (__m128d)a; }
SSE2 __m128i _mm_castps_si128(__m128 a) { return (__m128i)a; }
SSE2 __m128 _mm_castsi128_ps(__m128i a) { return (__m128)a; }

// ---- four ints ----
SSE2 __m128i _mm_setr_epi32(int a, int b, int c, int d) { return (__m128i)sse2_ints{a, b, c, d}; }
SSE2 __m128i _mm_set_epi32(int d, int c, int b, int a) { return _mm_setr_epi32(a, b, c, d); }
SSE2 __m128i _mm_set1_epi32(int a) { return _mm_setr_epi32(a, a, a, a); }
SSE2 __m128i _mm_set1_epi64x(long long a) { return __m128i{a, a}; }
SSE2 __m128i _mm_setzero_si128() { return __m128i{0, 0}; }
SSE2 int _mm_cvtsi128_si32(__m128i a) { return ((sse2_ints)a)[0]; }

SSE2 __m128i _mm_loadu_si128(const __m128i* from) {
  __m128i a;
  __builtin_memcpy(&a, from, sizeof a);
  return a;
}
SSE2 __m128i _mm_load_si128(const __m128i* from) { return _mm_loadu_si128(from); }
SSE2 void _mm_storeu_si128(__m128i* to, __m128i a) { __builtin_memcpy(to, &a, sizeof a); }
SSE2 void _mm_store_si128(__m128i* to, __m128i a) { _mm_storeu_si128(to, a); }

SSE2 __m128i _mm_add_epi32(__m128i a, __m128i b) { return (__m128i)((sse2_ints)a + (sse2_ints)b); }
SSE2 __m128i _mm_sub_epi32(__m128i a, __m128i b) { return (__m128i)((sse2_ints)a - (sse2_ints)b); }
SSE2 __m128i _mm_and_si128(__m128i a, __m128i b) { return a & b; }
SSE2 __m128i _mm_or_si128(__m128i a, __m128i b) { return a | b; }
SSE2 __m128i _mm_xor_si128(__m128i a, __m128i b) { return a ^ b; }
SSE2 __m128i _mm_andnot_si128(__m128i a, __m128i b) { return ~a & b; }
SSE2 __m128i _mm_cmpeq_epi32(__m128i a, __m128i b) { return (__m128i)((sse2_ints)a == (sse2_ints)b); }
SSE2 __m128i _mm_cmplt_epi32(__m128i a, __m128i b) { return (__m128i)((sse2_ints)a < (sse2_ints)b); }
SSE2 __m128i _mm_cmpgt_epi32(__m128i a, __m128i b) { return (__m128i)((sse2_ints)a > (sse2_ints)b); }
SSE2 __m128i _mm_unpackhi_epi64(__m128i a, __m128i b) { return __m128i{a[1], b[1]}; }
SSE2 __m128i _mm_shuffle_epi32(__m128i a, int places) {
  const sse2_ints from = (sse2_ints)a;
  return _mm_setr_epi32(from[places & 3], from[places >> 2 & 3], from[places >> 4 & 3], from[places >> 6 & 3]);
}

#define _MM_SHUFFLE(d, c, b, a) ((d) << 6 | (c) << 4 | (b) << 2 | (a))
#define _MM_HINT_T0 3
#define _mm_prefetch(address, hint) __builtin_prefetch(address)

// ---- never called by the core: singles, bytes, conversions ----
typedef __m128 sse2_of_singles(__m128, __m128);
typedef __m128i sse2_of_integers(__m128i, __m128i);
typedef __m128i sse2_shift(__m128i, int);
sse2_of_singles _mm_add_ps, _mm_sub_ps, _mm_mul_ps, _mm_div_ps, _mm_min_ps, _mm_max_ps, _mm_add_ss, _mm_mul_ss, _mm_min_ss, _mm_max_ss;
sse2_of_singles _mm_and_ps, _mm_or_ps, _mm_xor_ps, _mm_andnot_ps, _mm_cmpeq_ps, _mm_cmplt_ps, _mm_cmple_ps, _mm_cmpgt_ps, _mm_cmpnge_ps;
sse2_of_singles _mm_unpacklo_ps, _mm_unpackhi_ps, _mm_movelh_ps, _mm_movehl_ps;
__m128 _mm_set_ps(float, float, float, float), _mm_set_ps1(float), _mm_set_ss(float), _mm_setzero_ps();
__m128 _mm_load_ps(const float*), _mm_loadu_ps(const float*), _mm_sqrt_ps(__m128), _mm_sqrt_ss(__m128), _mm_rsqrt_ps(__m128);
__m128 _mm_shuffle_ps(__m128, __m128, int), _mm_cvtpd_ps(__m128d), _mm_cvtepi32_ps(__m128i);
void _mm_store_ps(float*, __m128), _mm_storeu_ps(float*, __m128), _mm_storel_pi(__m64*, __m128);
void _MM_TRANSPOSE4_PS(__m128&, __m128&, __m128&, __m128&);
float _mm_cvtss_f32(__m128);
int _mm_movemask_ps(__m128);
__m128d _mm_cvtps_pd(__m128), _mm_cvtepi32_pd(__m128i), _mm_load_sd(const double*);
sse2_of_integers _mm_mul_epu32, _mm_cmpeq_epi8, _mm_unpacklo_epi8, _mm_unpackhi_epi8, _mm_unpacklo_epi16, _mm_unpackhi_epi16;
sse2_of_integers _mm_unpacklo_epi32, _mm_unpackhi_epi32, _mm_unpacklo_epi64;
sse2_shift _mm_srai_epi32, _mm_srli_epi32, _mm_slli_epi32, _mm_slli_epi16, _mm_srli_epi16, _mm_slli_epi64, _mm_srli_epi64;
sse2_shift _mm_shufflelo_epi16, _mm_shufflehi_epi16;
__m128i _mm_cvttps_epi32(__m128), _mm_cvtpd_epi32(__m128d), _mm_loadl_epi64(const __m128i*), _mm_set1_epi8(char);
__m128i _mm_set_epi8(char, char, char, char, char, char, char, char, char, char, char, char, char, char, char, char);
