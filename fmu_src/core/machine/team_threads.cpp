/// A team of threads:
///
///      calling thread:      new round | own piece | pieces that nobody has begun | wait for the others' | on with the step
///      a helper:            ... wait  | own piece | pieces that nobody has begun | wait ...
///
/// A piece is taken by the first thread that comes to it; a thread takes its own piece before others. A helper that the system lets wait
/// thus costs nothing, and in the child of a fork, which has no helpers, the calling thread does all pieces. Between two rounds helpers
/// spin for half a millisecond, most of it yielding to other threads, and then sleep. Helpers have the floating-point environment that
/// results assume, and no signal is delivered to them.
#include <atomic>
#include <cfenv>
#include <exception>
#include <thread>
#include <vector>

#include "machine/team.hpp"

#ifndef _WIN32
#include <signal.h>
#include <unistd.h>
#endif

namespace softffd {

namespace {

/// looks: tests of a value that another thread will change, some 50 microseconds; the parts of a step differ by much less. patient_looks:
/// further tests, with a yield to other threads after each, half a millisecond: as long as many hosts take from one communication step to
/// the next. A thread that sleeps wakes up late: with 12^3 points and each internal step a communication step, two threads take 0.83
/// times the time of one thread, and 1.25 times without `patient_looks` (measured).
constexpr int looks = 2000, patient_looks = 1000;

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  __asm__ volatile("yield");
#endif
}

/// Returns when the value is no longer `old`.
template <class T>
void await_change(const std::atomic<T>& value, T old) {
  for (int look = 0; look < looks; ++look, pause())
    if (value.load(std::memory_order_acquire) != old) return;
  for (int look = 0; look < patient_looks; ++look, std::this_thread::yield())
    if (value.load(std::memory_order_acquire) != old) return;
  value.wait(old, std::memory_order_acquire);
}

#ifdef _WIN32
long this_process() { return 0; }
struct SignalsBlocked {};
#else
long this_process() { return getpid(); }
/// Blocks all signals for the threads that are made during its lifetime.
struct SignalsBlocked {
  SignalsBlocked() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
  }
  ~SignalsBlocked() { pthread_sigmask(SIG_SETMASK, &before, nullptr); }
  sigset_t before;
};
#endif

}  // namespace

struct Team::Helpers {
  explicit Helpers(int members) : pieces(members), threads(new std::vector<std::thread>), process(this_process()) {
    threads->reserve(members - 1);
    [[maybe_unused]] const SignalsBlocked blocked;
    try {
      for (int own = 1; own < members; ++own) threads->emplace_back([this, own] { help(own); });
    } catch (const std::exception&) {  // the system gives no more threads
    }
  }
  ~Helpers() {
    if (process != this_process()) {  // the child of a fork has no threads to wait for
      static_cast<void>(threads.release());
      return;
    }
    over.store(true, std::memory_order_relaxed);
    round.fetch_add(1, std::memory_order_release);
    round.notify_all();
    for (std::thread& helper : *threads) helper.join();
  }

  void run(const StepContext& context) {
    job = context;
    left.store(members(), std::memory_order_relaxed);
    const unsigned next = round.load(std::memory_order_relaxed) + 1;
    round.store(next, std::memory_order_release);
    round.notify_all();
    take_pieces(0, next);
    while (const int others = left.load(std::memory_order_acquire)) await_change(left, others);
  }
  /// A helper that comes late to a round finds all pieces of the round begun, and does not read `job`.
  void take_pieces(int own, unsigned of_round) {
    for (int n = 0; n < members(); ++n) {
      const int piece = (own + n) % members();
      unsigned before = of_round - 1;
      if (!pieces[piece].round.compare_exchange_strong(before, of_round, std::memory_order_acq_rel)) continue;
      job.act(job.of, piece);
      if (left.fetch_sub(1, std::memory_order_acq_rel) == 1) left.notify_all();
    }
  }
  void help(int own) {
    std::fesetenv(FE_DFL_ENV);
    for (unsigned last = 0;;) {
      await_change(round, last);
      last = round.load(std::memory_order_acquire);
      if (over.load(std::memory_order_relaxed)) return;
      take_pieces(own, last);
    }
  }
  int members() const { return int(pieces.size()); }

  static constexpr int cache_line = 64;
  struct alignas(cache_line) Piece {
    std::atomic<unsigned> round{0};  ///< round in which the piece was begun last
  };
  std::vector<Piece> pieces;
  StepContext job{};
  alignas(cache_line) std::atomic<unsigned> round{0};
  alignas(cache_line) std::atomic<int> left{0};  ///< pieces of the round that have not ended
  std::atomic<bool> over{false};
  std::unique_ptr<std::vector<std::thread>> threads;
  long process;  ///< process in which the threads are
};

Team::Team(int members) : members_(members), helpers_(std::make_unique<Helpers>(members)) {}

Team::~Team() = default;

void Team::run(const StepContext& context) { helpers_->run(context); }

}  // namespace softffd
