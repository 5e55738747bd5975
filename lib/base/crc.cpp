#include <array>

#include "base/bytes.hpp"
#include "base/cpu.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

// CRC-32 of zip, gzip and PNG: the remainder of a polynomial over GF(2), bits reflected, that a table of bytes gives (Sarwate
// 1988), four bytes at a time (slicing), and products without carries 64 bytes at a time (Gopal and others, "Fast CRC
// computation for generic polynomials using PCLMULQDQ", Intel 2009): with D(x) what is read and P the polynomial,
//   D_high x^n + D_low  =  D_high (x^n mod P) + D_low   (mod P),
// so that 16 bytes fold onto those that come n bits later by two products. All give the same number.
namespace rdm {
namespace {

// Table k has what a byte does with k more behind it.
constexpr std::array<std::array<uint32_t, 256>, 4> make_tables() {
  std::array<std::array<uint32_t, 256>, 4> t{};
  for (uint32_t i = 0; i < 256; ++i) {
    uint32_t c = i;
    for (int k = 0; k < 8; ++k) c = (c & 1u) ? 0xEDB88320u ^ (c >> 1) : c >> 1;
    t[0][i] = c;
  }
  for (size_t k = 1; k < 4; ++k)
    for (size_t i = 0; i < 256; ++i) t[k][i] = t[0][t[k - 1][i] & 0xFFu] ^ (t[k - 1][i] >> 8);
  return t;
}
constexpr auto kTable = make_tables();

uint32_t by_table(const unsigned char* p, size_t size, uint32_t crc) {
  const auto at = [&](uint32_t k) { return static_cast<uint32_t>(p[k]) << 8 * k; };
  for (; size >= 4; p += 4, size -= 4) {
    crc ^= at(0) | at(1) | at(2) | at(3);
    crc = kTable[3][crc & 0xFFu] ^ kTable[2][crc >> 8 & 0xFFu] ^ kTable[1][crc >> 16 & 0xFFu] ^
          kTable[0][crc >> 24];
  }
  for (; size > 0; ++p, --size) crc = kTable[0][(crc ^ *p) & 0xFFu] ^ (crc >> 8);
  return crc;
}

#if defined(__x86_64__)
#define RDM_CARRYLESS __attribute__((target("pclmul,sse4.1")))

// x times two constants, one for each half.
RDM_CARRYLESS inline __m128i folded(__m128i x, __m128i k) {
  return _mm_xor_si128(_mm_clmulepi64_si128(x, k, 0x00), _mm_clmulepi64_si128(x, k, 0x11));
}

// Of 64 bytes or more, a multiple of 16. Constants are x^n mod P, reflected, of the paper's table for this polynomial.
RDM_CARRYLESS uint32_t by_products(const unsigned char* p, size_t size, uint32_t crc) {
  const __m128i by_512 = _mm_set_epi64x(0x1C6E41596, 0x154442BD4),
                by_128 = _mm_set_epi64x(0x0CCAA009E, 0x1751997D0);
  const auto load = [](const unsigned char* q)
                        RDM_CARRYLESS { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(q)); };
  __m128i x[4];
  for (int i = 0; i < 4; ++i) x[i] = load(p + 16 * i);
  x[0] = _mm_xor_si128(x[0], _mm_cvtsi32_si128(static_cast<int>(crc)));
  for (p += 64, size -= 64; size >= 64; p += 64, size -= 64)
    for (int i = 0; i < 4; ++i) x[i] = _mm_xor_si128(folded(x[i], by_512), load(p + 16 * i));
  __m128i sum = x[0];
  for (int i = 1; i < 4; ++i) sum = _mm_xor_si128(folded(sum, by_128), x[i]);
  for (; size >= 16; p += 16, size -= 16) sum = _mm_xor_si128(folded(sum, by_128), load(p));
  // 128 bits to 64, with 32 zeros behind, and from there by Barrett's reduction
  const __m128i low = _mm_setr_epi32(-1, 0, -1, 0), by_64 = _mm_set_epi64x(0, 0x163CD6124),
                barrett = _mm_set_epi64x(0x1F7011641, 0x1DB710641);
  sum = _mm_xor_si128(_mm_srli_si128(sum, 8), _mm_clmulepi64_si128(sum, by_128, 0x10));
  sum = _mm_xor_si128(_mm_srli_si128(sum, 4), _mm_clmulepi64_si128(_mm_and_si128(sum, low), by_64, 0x00));
  const __m128i quotient = _mm_clmulepi64_si128(_mm_and_si128(sum, low), barrett, 0x10),
                product = _mm_clmulepi64_si128(_mm_and_si128(quotient, low), barrett, 0x00);
  return static_cast<uint32_t>(_mm_extract_epi32(_mm_xor_si128(sum, product), 1));
}
#endif

}  // namespace

uint32_t crc32(const void* data, size_t size, uint32_t crc) {
  const auto* p = static_cast<const unsigned char*>(data);
  crc = ~crc;
#if defined(__x86_64__)
  if (size >= 64 && cpu().carryless) {
    const size_t whole = size / 16 * 16;
    crc = by_products(p, whole, crc);
    p += whole;
    size -= whole;
  }
#endif
  return ~by_table(p, size, crc);
}

}  // namespace rdm
