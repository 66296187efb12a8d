// From a loop to a function in memory, by LLVM's just-in-time compiler; and the one symbol that the program asks for.
#include <llvm/ExecutionEngine/Orc/LLJIT.h>
#include <llvm/IR/Verifier.h>
#include <llvm/Support/TargetSelect.h>

#include <mutex>

#include "native/llvm/loop_writer.hpp"

namespace sysid::native {
namespace {

class CompiledLoop : public Machine {
 public:
  CompiledLoop(std::unique_ptr<llvm::orc::LLJIT> compiler, Function function)
      : compiler_(std::move(compiler)), function_(function) {}
  Function function() const override { return function_; }

 private:
  std::unique_ptr<llvm::orc::LLJIT> compiler_;  // owns the memory
  Function function_;
};

/// This processor; without 512-bit vectors where they are not asked for.
llvm::Expected<llvm::orc::JITTargetMachineBuilder> target_of(Loop const& loop) {
  auto target = llvm::orc::JITTargetMachineBuilder::detectHost();
  if (!target) return target;
  llvm::TargetOptions& options = target->getOptions();
  options.AllowFPOpFusion = llvm::FPOpFusion::Strict;  // fused operations are written; nothing else is fused
  options.UnsafeFPMath = options.NoInfsFPMath = options.NoNaNsFPMath = options.NoSignedZerosFPMath = false;
  if (!loop.wide) target->getFeatures().AddFeature("avx512f", false);
  target->setCodeGenOptLevel(llvm::CodeGenOpt::Default);
  return target;
}

llvm::Expected<std::unique_ptr<Machine>> compiled(Loop const& loop) {
  auto target = target_of(loop);
  if (!target) return target.takeError();
  auto compiler = llvm::orc::LLJITBuilder()
                      .setJITTargetMachineBuilder(std::move(*target))
                      .setPlatformSetUp(llvm::orc::setUpInactivePlatform)
                      .create();
  if (!compiler) return compiler.takeError();
  // A failure comes back as the answer to the look-up; its reason is only reported, by default on standard error.
  auto const reason = std::make_shared<std::string>();
  (*compiler)->getExecutionSession().setErrorReporter([reason](llvm::Error error) { *reason = llvm::toString(std::move(error)); });
  auto context = std::make_unique<llvm::LLVMContext>();
  auto module = std::make_unique<llvm::Module>("sysid", *context);
  module->setDataLayout((*compiler)->getDataLayout());
  module->setTargetTriple((*compiler)->getTargetTriple().str());
  if (!LoopWriter(*module, loop, {}).write("loop") || llvm::verifyModule(*module))
    return llvm::createStringError(llvm::inconvertibleErrorCode(), "the compiler of machine code does not know this program");
  if (auto error = (*compiler)->addIRModule({std::move(module), std::move(context)})) return error;
  auto symbol = (*compiler)->lookup("loop");
  if (!symbol) {
    std::string const failure = llvm::toString(symbol.takeError());
    return llvm::createStringError(llvm::inconvertibleErrorCode(), reason->empty() ? failure : *reason);
  }
  auto const function = reinterpret_cast<Function>(symbol->getAddress());
  return std::make_unique<CompiledLoop>(std::move(*compiler), function);
}

std::unique_ptr<Machine> compile(Loop const& loop, std::string& why) {
  static std::once_flag once;
  std::call_once(once, [] {
    llvm::InitializeNativeTarget();
    llvm::InitializeNativeTargetAsmPrinter();
  });
  auto result = compiled(loop);
  if (result) return std::move(*result);
  why = llvm::toString(result.takeError());
  return nullptr;
}

}  // namespace
}  // namespace sysid::native

extern "C" __attribute__((visibility("default"))) sysid::native::Module const* sysid_native_module() {
  static sysid::native::Module const module{SYSID_VERSION, &sysid::native::compile};
  return &module;
}
