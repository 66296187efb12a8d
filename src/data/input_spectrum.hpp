// What the samples of an input say of the curve between them.
#pragma once
#include "data/experiment.hpp"

namespace sysid {

struct InputSpectrum {
  bool constant = false;     // then nothing else is set
  double low = 0, high = 0;  // [rate] between them lies 99 % of the power
  double top = 0;            // share of the power above 0.4 of the sampling rate
  double chords = 0;         // rms of what straight lines leave out at the middle of intervals, over the input's sd
};

/// From a periodogram of the samples less their mean, and the spline through them. rate: of the samples, Hz.
InputSpectrum input_spectrum(InputSignal const& signal, double rate);

/// Whether straight lines between the samples are not the curve that these were taken from: next to no power is near half the
/// sampling rate, so that the curve is known between them, and the lines leave out half a percent of it.
bool cut_by_lines(InputSpectrum const& spectrum);

}  // namespace sysid
