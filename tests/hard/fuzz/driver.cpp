// Stands between libFuzzer (or a loop of its own) and a target.
//
//   fuzz_x --seeds FOLDER       writes the seeds there and ends
//   fuzz_x [libFuzzer's flags]  built with -fsanitize=fuzzer
//   fuzz_x [--seconds S] [--runs N] [--seed N] [FILE or FOLDER]...
//                               built without: files are run as they are, then changed seeds for S seconds or
//                               N inputs
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "fuzz.hpp"

namespace {

using hard::Bytes;

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

int write_seeds(const std::string& folder) {
  std::filesystem::create_directories(folder);
  size_t i = 0;
  for (const Bytes& s : hard::seeds()) {
    std::ofstream out(folder + "/seed-" + std::to_string(i++), std::ios::binary);
    out.write(reinterpret_cast<const char*>(s.data()), static_cast<std::streamsize>(s.size()));
  }
  std::printf("%zu seeds\n", i);
  return 0;
}

// Numbers that find edges: as floats, doubles and integers.
void odd_number(unsigned char* at, size_t room, uint32_t r) {
  static const double doubles[] = {0.0, -1, 1e300, -1e300, 1e-300, std::nan(""), HUGE_VAL, 0.5, 1e6, -1e9};
  static const float floats[] = {0, -1, 1e38f, -1e38f, 1e-40f, std::nanf(""), HUGE_VALF, 2, 1e6f, 100};
  static const int32_t ints[] = {0, -1, 1, 255, 65536, 0x20000000, 0x7fffffff, INT32_MIN, 3, 17};
  static const int64_t longs[] = {0, -1, INT64_MAX, INT64_MIN, 0x100000000, 1000000};
  const uint32_t which = r >> 2 & 0xffff;
  const size_t wide = r % 4 < 2 ? 8 : 4;
  if (room < wide) return;
  if (r % 4 == 0) std::memcpy(at, &doubles[which % std::size(doubles)], 8);
  if (r % 4 == 1) std::memcpy(at, &longs[which % std::size(longs)], 8);
  if (r % 4 == 2) std::memcpy(at, &floats[which % std::size(floats)], 4);
  if (r % 4 == 3) std::memcpy(at, &ints[which % std::size(ints)], 4);
}

uint32_t next(uint32_t& state) {
  state ^= state << 13;
  state ^= state >> 17;
  state ^= state << 5;
  return state;
}

// A change within the contents of a checked file: one number, or one byte.
void change_contents(unsigned char* data, size_t size, uint32_t& state) {
  size_t begin = 0;
  while (begin + hard::kFileHead <= size && begin < 16 && std::memcmp(data + begin, "RDM", 3) != 0) ++begin;
  std::vector<hard::Span> spans;
  if (begin + hard::kFileHead <= size && hard::is_file(data + begin, size - begin))
    hard::payloads(data, begin, size - begin, spans);
  if (spans.empty()) spans.push_back({hard::fixed_bytes(), size});
  for (uint32_t n = 1 + next(state) % 3; n; --n) {
    const hard::Span s = spans[next(state) % spans.size()];
    if (s.end <= s.begin) continue;
    const size_t at = s.begin + next(state) % (s.end - s.begin), aligned = s.begin + (at - s.begin) / 4 * 4;
    if (next(state) % 4 == 0)
      data[at] = static_cast<unsigned char>(next(state));
    else
      odd_number(data + aligned, s.end - aligned, next(state));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const double begin = cpu_seconds();
  hard::one(data, size);
  const double took = cpu_seconds() - begin;
  // an input of a few kB never takes a second of the processor
  if (took > 1) {
    std::fprintf(stderr, "an input of %zu bytes took %.2f s\n", size, took);
    std::abort();
  }
  return 0;
}

#ifdef RDM_LIBFUZZER
extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t most);

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  if (*argc == 3 && std::strcmp((*argv)[1], "--seeds") == 0) std::exit(write_seeds((*argv)[2]));
  return 0;
}

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t most, unsigned int seed) {
  uint32_t state = seed | 1;
  if (next(state) % 2 == 0)
    change_contents(data, size, state);
  else
    size = LLVMFuzzerMutate(data, size, most);
  if (next(state) % 8 != 0) hard::whole(data, size);
  return size;
}

#else

namespace {

Bytes read_all(const std::string& path) {
  Bytes out(static_cast<size_t>(std::filesystem::file_size(path)));
  std::ifstream(path, std::ios::binary)
      .read(reinterpret_cast<char*>(out.data()), static_cast<std::streamsize>(out.size()));
  return out;
}

// An input; kept for the report of an input that ends the process.
constexpr size_t kMostBytes = 1 << 16;
Bytes g_input;
std::string g_target;

void keep_input(int signal) {
  const std::string path = "crash-" + g_target;
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(g_input.data()), static_cast<std::streamsize>(g_input.size()));
  std::fprintf(stderr, "signal %d: the input of %zu bytes is in %s\n", signal, g_input.size(), path.c_str());
  _exit(1);
}

void run(const Bytes& input) {
  g_input = input;
  alarm(20);
  LLVMFuzzerTestOneInput(g_input.data(), g_input.size());
  alarm(0);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::strcmp(argv[1], "--seeds") == 0) return write_seeds(argv[2]);
  g_target = std::filesystem::path(argv[0]).filename();
  for (int s : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL, SIGALRM, SIGTERM}) std::signal(s, keep_input);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const rlimit room{1UL << 30, 1UL << 30};  // no input of a few kB needs a GB
  setrlimit(RLIMIT_AS, &room);
#endif
  double seconds = 1;
  long runs = -1, done = 0;
  uint32_t state = 1;
  std::vector<Bytes> corpus = hard::seeds();
  for (int i = 1; i < argc; ++i) {
    const std::string a = argv[i];
    if (i + 1 < argc && a == "--seconds")
      seconds = std::atof(argv[++i]);
    else if (i + 1 < argc && a == "--runs")
      runs = std::atol(argv[++i]);
    else if (i + 1 < argc && a == "--seed")
      state = static_cast<uint32_t>(std::atol(argv[++i])) | 1;
    else if (std::filesystem::is_directory(a))
      for (const auto& e : std::filesystem::directory_iterator(a)) corpus.push_back(read_all(e.path()));
    else
      corpus.push_back(read_all(a));
  }
  for (const Bytes& input : corpus) run(input);
  using clock = std::chrono::steady_clock;
  const auto end = clock::now() + std::chrono::duration<double>(seconds);
  for (; runs < 0 ? clock::now() < end : done < runs; ++done) {
    Bytes input = corpus[next(state) % corpus.size()];
    if (input.empty()) input.resize(1);
    const uint32_t kind = next(state) % 8;
    if (kind == 0) input.resize(1 + next(state) % input.size());
    if (kind == 1 && input.size() < kMostBytes) {  // a piece twice
      const size_t from = next(state) % input.size(), n = 1 + next(state) % (input.size() - from);
      const size_t to = next(state) % input.size(), old = input.size();
      input.resize(old + n);
      std::memmove(input.data() + to + n, input.data() + to, old - to);
      std::memmove(input.data() + to, input.data() + from, n);  // whatever lies there now
    }
    if (kind == 2)
      for (uint32_t n = 1 + next(state) % 4; n; --n)
        input[next(state) % input.size()] = static_cast<unsigned char>(next(state));
    if (kind > 2) change_contents(input.data(), input.size(), state);
    if (next(state) % 8 != 0) hard::whole(input.data(), input.size());
    run(input);
  }
  std::printf("%s: %ld inputs, %zu seeds\n", g_target.c_str(), done, corpus.size());
  return 0;
}
#endif
