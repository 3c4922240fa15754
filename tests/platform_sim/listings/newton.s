/* Four reciprocals at once: an estimate, then a Newton step. */
        .text
        .align  3
newton:
        hbrr    .Lback, newton     # 8 instructions before its branch
        lqd     $4, 0($3)          # x
        ai      $7, $7, -1
        frest   $5, $4             # odd pipe
        fi      $5, $4, $5
        fnms    $6, $4, $5, $10    # 1 - x * y
        fma     $5, $6, $5, $5
        stqd    $5, 0($3)
        ai      $3, $3, 16
.Lback: brnz    $7, newton
        bi      $lr
