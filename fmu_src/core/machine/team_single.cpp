/// A team on a target without threads: there are no helpers, and the calling thread does one piece after the other.
#include "machine/team.hpp"

namespace softffd {

struct Team::Helpers {};

Team::Team(int members) : members_(members) {}

Team::~Team() = default;

void Team::run(const StepContext& context) {
  for (int piece = 0; piece < members_; ++piece) context.act(context.of, piece);
}

}  // namespace softffd
