# The listing that IBM published with its static timing tool's output (row C23), with the operands
# that the print leaves out (what ila and lqa load, where brnz goes).
loop:
  a 49,8,10; lqx 51,6,9; ila 47,66051; lqx 52,6,11
  ai 7,7,-1; fma 50,51,12,52; stqx 50,6,11; lqx 48,8,10
  ai 8,8,4; lqa 44,0; lqx 43,6,9; rotqby 46,48,49
  shufb 45,46,46,47; fm 42,12,45; fma 41,42,44,43; stqx 41,6,9
  ai 6,6,16; brnz 7,loop
