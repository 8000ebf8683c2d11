// The way that ω has come: points at even times, computed when they are first shown.

import { rotate } from "./vectors.js";

const SHOWN = 2400;
const STEP = Math.PI / 22; // turn from point to point

export class Trail {
  /** stateAt: of a time from 0 on, in the direction of the motion; axis: of a top, in the body; onSphere: from an attitude to where L points in the body; placeAt: of a body that rolls, from a time and an attitude to where it touches; apart: the greatest time between two points. */
  constructor(stateAt, fastest, span, { axis, onSphere, placeAt, apart }) {
    Object.assign(this, { stateAt, axis, onSphere, placeAt, points: [] });
    this.step = Math.min(STEP / (fastest || 1), Math.abs(span) / 60 || 1, apart);
  }

  /** What is to be drawn up to a time: lists of ω in the body, ω in space, the top's axis in space, where L points in the body, and where a body that rolls touches. */
  upTo(since) {
    const last = Math.floor(Math.abs(since) / this.step), first = Math.max(0, last - SHOWN);
    const body = [], space = [], axis = [], sphere = [], contact = [];
    for (let k = first; k <= last; k++) {
      const point = this.points[k] ??= this.point(Math.sign(since) * k * this.step);
      body.push(point[0]); space.push(point[1]); axis.push(point[2]); sphere.push(point[3]); contact.push(point[4]);
    }
    return { body, space, axis, sphere, contact };
  }

  point(since) {
    const { omega, q } = this.stateAt(since);
    return [omega, rotate(q, omega), this.axis && rotate(q, this.axis), this.onSphere && this.onSphere(q), this.placeAt && this.placeAt(since, q)];
  }
}
