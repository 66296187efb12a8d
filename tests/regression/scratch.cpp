#include <doctest/doctest.h>
#include <fmt/ranges.h>
#include <ctime>
#include "regression/problems.hpp"
using namespace sysid; using namespace sysid::regression;
TEST_CASE("scratch duffing") {
  for (auto sel : {"spike_slab","ard","threshold"}) for (int n : {500,2000}) for (double noise : {0.01,0.05}) for (int half : {0,15,20,25,30}) {
    int exact=0, all=0, most=0; double e[4]={0,0,0,0}; double ratio=0; int hw=0; auto c0=clock(); std::string sp;
    for (int s=1;s<=40;++s) {
      auto d=duffing_dictionary(); std::vector<Experiment> ex={duffing_record(s,n,noise)};
      auto m=method(sel); m.form_settings.set("half_width",std::int64_t(half)); auto r=discover(d,ex,m); auto& q=r.equations[0];
      auto k=kept(q); int t=0; for (int j: {0,1,2,4}) t+=q.terms[j].kept; int spur=(int)k.size()-t;
      exact+=t==4&&spur==0; all+=t==4; most=std::max(most,spur); sp+=fmt::format(" {}/{}",t,spur); hw=r.half_width; ratio+=q.noise_ratio/40;
      double truth[]={1,20,1e4,5e9}; int js[]={0,1,2,4}; if (t==4&&spur==0) for(int i=0;i<4;++i) e[i]=std::max(e[i],std::abs(q.terms[js[i]].coefficient/truth[i]-1)*100);
      if(s==1&&half==0&&noise==0.01) for (auto& cc: q.concerns) fmt::print("   {}\n",cc.clause);
    }
    fmt::print("{} n {} noise {} half {} exact {} all {} worst err% {:.3f} ratio {:.2f} spur{} {:.2f}s\n",sel,n,noise,hw,exact,all,fmt::join(e," "),ratio,sp,double(clock()-c0)/CLOCKS_PER_SEC);
  }
}
TEST_CASE("scratch systems") {
  for (auto sel : {"spike_slab","ard","threshold"})
  for (auto which : {"lorenz","predator-prey"}) for (int rec : {0,1}) for (int deg : {2, std::string(which)=="lorenz"?5:3}) {
    std::vector<std::string> st = std::string(which)=="lorenz"? std::vector<std::string>{"x","y","z"}:std::vector<std::string>{"prey","predator"};
    auto d=polynomial_dictionary(st,deg); std::vector<Experiment> ex={recorded(fmt::format("/work/shared/data/discovery-{}/record_{}.csv",which,rec))};
    auto c0=clock(); auto r=discover(d,ex,method(sel));
    fmt::print("{} {} {} deg {} half {} {:.2f}s\n",sel,which,rec,deg,r.half_width,double(clock()-c0)/CLOCKS_PER_SEC);
    for (auto& q: r.equations) { fmt::print("   {} rows {} ratio {:.2f} it {}:",q.name,q.rows,q.noise_ratio,q.iterations); for (auto& t: q.terms) if (t.kept) fmt::print(" {}={:.4g}({:.2f})",t.name,t.coefficient,t.measure); fmt::print("\n"); for (auto& cc: q.concerns) fmt::print("      {}\n",cc.clause);}
  }
}
