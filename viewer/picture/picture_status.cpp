#include "viewer/picture/picture_status.hpp"

namespace palpate {

LoopFigures figuresOf(const LoopStatistics& statistics) {
  LoopFigures figures;
  figures.rate = statistics.rate;
  figures.period_p50 = statistics.period.quantile(0.5);
  figures.period_p999 = statistics.period.quantile(0.999);
  figures.compute_p50 = statistics.compute.quantile(0.5);
  figures.compute_p999 = statistics.compute.quantile(0.999);
  figures.ticks = statistics.ticks;
  figures.missed_program = statistics.missed_program;
  figures.missed_system = statistics.missed_system;
  figures.halts = statistics.halts;
  figures.guards = statistics.guards;
  return figures;
}

}  // namespace palpate
