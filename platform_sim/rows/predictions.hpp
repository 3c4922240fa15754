// What the models predict for the measured rows: a function a kind of row, of the form that
// RowDefinition::predict wants.
#pragma once

#include <cstdint>
#include <string>

#include "platform_sim/platforms/platform.hpp"

namespace pelt::rows {

using PredictFunction = bool(const PlatformParameters& p, double availability, uint32_t argument,
                             double& predicted, std::string& error);

// SPU (spu_rows.cpp). A rate is of all SPUs together.
PredictFunction SinglePrecisionRate, IntegerRate, ShuffleRate, DualIssueRate;
PredictFunction NewtonRate, EvenNopNewtonRate, DoublePrecisionRate;
PredictFunction BranchIteration, HintedBranchIteration, MatrixPeakShare, PublishedIteration,
    PublishedIssueTimes;

// PPE and Xenon cores (ppe_rows.cpp). `argument`: bytes walked through.
PredictFunction PpeChase, PpeIndexChase, PpeStream, PpePrefetchedStream;
PredictFunction PpeVectorFma, PpeScalarFma, PpeIntegerAdd;
PredictFunction PpeScalarFmaTwice, PpeScalarFmaBesideAdds, PpeAddsBesideScalarFma;
PredictFunction XenonLoadHitStore, XenonSynchronisation, XenonSecondThreadGain;

// DMA and bus (cell_rows.cpp). `argument`: bytes of a block.
PredictFunction DoubleBufferedReads, DoubleBufferedWrites, EightInFlight;
PredictFunction PairsBothWays, OneStoreReadByAll, OnePairAfterAnother;
PredictFunction AtomicBounce, Mailbox;

// Jobs (cell_rows.cpp). `argument`: microseconds of a job.
PredictFunction JobsOnOneSpe, FloorOfShortJobs;

}  // namespace pelt::rows
