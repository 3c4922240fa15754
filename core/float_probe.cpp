// Compiled to assembly when Pelt is configured, never linked: float_probe.cmake looks for the
// operations that stand here.
extern "C" float PeltProbeOne(float a, float b, float c) { return a * b + c; }
extern "C" float PeltProbeTwo(float a, float b) { return (a + b) - a; }
extern "C" float PeltProbeThree(float a) { return a / 3.0f; }
