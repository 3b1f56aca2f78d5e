/// Counts the instructions that a call executes, exactly: with its trap flag set the processor stops after every one, and the signal's
/// handler counts. Needs no rights and no tools, only time: some microseconds an instruction. For Linux on x86-64.
///
/// Those of this program alone count: which loops the C library takes for copying depends on the processor. An instruction that repeats
/// itself stops every time, and counts once.
#pragma once
#if defined(__linux__) && defined(__x86_64__)
#define SOFTFFD_COUNTS_INSTRUCTIONS
#include <ucontext.h>
#include <csignal>
#include <cstdint>

extern "C" const char __executable_start, etext;  // of the linker

namespace softffd {

class InstructionCounter {
 public:
  InstructionCounter() {
    struct sigaction action = {};
    action.sa_sigaction = stopped;
    action.sa_flags = SA_SIGINFO;
    sigaction(SIGTRAP, &action, nullptr);
  }

  /// Of a call that has been made before, so that nothing is done for the first time.
  template <class Call>
  std::int64_t count(Call&& call) {
    count_ = 0;
    last_ = 0;
    // past the 128 bytes below the stack's end, which may be in use
    __asm__ volatile("sub $128, %%rsp; pushf; orq $0x100, (%%rsp); popf; add $128, %%rsp" ::: "memory", "cc");
    call();
    __asm__ volatile("sub $128, %%rsp; pushf; andq $~0x100, (%%rsp); popf; add $128, %%rsp" ::: "memory", "cc");
    return count_;
  }

 private:
  static void stopped(int, siginfo_t*, void* context) {
    const auto next = std::uintptr_t(static_cast<ucontext_t*>(context)->uc_mcontext.gregs[REG_RIP]);
    const bool own = next - std::uintptr_t(&__executable_start) < std::uintptr_t(&etext) - std::uintptr_t(&__executable_start);
    if (own && next != last_) count_ = count_ + 1;
    last_ = next;
  }
  static inline volatile std::int64_t count_ = 0;
  static inline volatile std::uintptr_t last_ = 0;
};

}  // namespace softffd
#endif
