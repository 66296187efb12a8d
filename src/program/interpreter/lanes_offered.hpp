// What a lane executor offers (declared in step.hpp), from the handlers of lanes_handlers.hpp. Included behind them in the
// namespace of each instruction set, so that every set has its own. No include guard and no includes, as there.

Handler handler(InstructionShape shape, int width) {
  return ask<Handler>(width, [&]<class M>(M) { return M::handler(shape); });
}

Handler end(int width) {
  return ask<Handler>(width, []<class M>(M) { return reinterpret_cast<Handler>(&M::end); });
}

void run(Step const* steps, char* file, int width) {
  ask<void>(width, [&]<class M>(M) { M::run(steps, file); });
}
