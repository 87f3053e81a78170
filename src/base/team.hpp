// Threads that do whole tasks, each all of a body, rather than parts of one.
#pragma once

namespace eulastic {

/// Marks a thread, from construction to destruction, as one that does tasks of a team: it shares its loops with no
/// other, logs no events and calls no MPI.
class TeamMember {
public:
  /// `number`: in the team, from 0 on. `flops`: those of its verbs are added there.
  TeamMember(int number, double *flops) noexcept;
  ~TeamMember();
  TeamMember(const TeamMember &) = delete;
  TeamMember &operator=(const TeamMember &) = delete;

  /// Whether this thread does tasks of a team.
  static bool is_here() noexcept;
  /// Its number there; 0 outside of any.
  static int number() noexcept;
  static void add_flops(double count) noexcept;
};

}  // namespace eulastic
