// The way that ω has come: points at even times, computed when they are first shown.

import { rotate } from "./vectors.js";

const SHOWN = 2400;
const STEP = Math.PI / 22; // turn from point to point

export class Trail {
  /** stateAt: of a time from 0 on, in the direction of the motion; axis: of a top, in the body. */
  constructor(stateAt, fastest, span, axis) {
    Object.assign(this, { stateAt, axis, points: [] });
    this.step = Math.min(STEP / (fastest || 1), Math.abs(span) / 60 || 1);
  }

  /** What is to be drawn up to a time: lists of ω in the body, ω in space, and the top's axis in space. */
  upTo(since) {
    const last = Math.floor(Math.abs(since) / this.step), first = Math.max(0, last - SHOWN);
    const body = [], space = [], axis = [];
    for (let k = first; k <= last; k++) {
      const point = this.points[k] ??= this.point(Math.sign(since) * k * this.step);
      body.push(point[0]); space.push(point[1]); axis.push(point[2]);
    }
    return { body, space, axis };
  }

  point(since) {
    const { omega, q } = this.stateAt(since);
    return [omega, rotate(q, omega), this.axis && rotate(q, this.axis)];
  }
}
