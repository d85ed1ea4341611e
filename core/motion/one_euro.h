#pragma once

namespace mocurate {

struct Motion;

/// The 1-euro filter (Casiez, Roussel, Vogel, CHI 2012): a low-pass whose cutoff rises with speed.
struct OneEuro {
  double least_cutoff_hz = 0.0;  ///< at zero speed; 0: no filter
  double speed = 0.007;          ///< Hz by which the cutoff rises for each m/s
  double speed_cutoff_hz = 1.0;  ///< of the low-pass of the speed itself

  bool on() const { return least_cutoff_hz > 0.0; }
};

/// Each coordinate of each joint filtered on its own, from the first frame on. Rotations are removed: they do not
/// match the filtered joints.
Motion OneEuroFiltered(const Motion& motion, const OneEuro& filter);

}  // namespace mocurate
